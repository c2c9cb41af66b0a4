# Experiments: their table, sweeps, maps of regimes, and the check against what was recorded.
# The runner goes by digests of programs, arguments and inputs: what is finished does not run again, what was
# changed does.
run: $(EXPERIMENTS)
	@$(if $(present),,echo 'No session of "$(SESSIONS)" has data in $(NCLT).'; exit 1)
	$(marked)
	@$(EXPERIMENTS) run $(table_of) --methods $(call listed,$(methods)) --threads $(threads)

table_arguments = $$($(EXPERIMENTS) plan --quiet --format results $(table_of) --methods $(call listed,$(METHODS))) \
                  --published pipelines/published.toml --methods $(call listed,$(METHODS)) \
                  $(if $(missing),--missing $(call listed,$(missing)))

table: run $(REPORT)
	@$(REPORT) table $(table_arguments) -o $(RESULTS)/table$(suffix).md
	@$(REPORT) table $(table_arguments) --format latex -o $(RESULTS)/table$(suffix).tex
	@$(REPORT) table $(table_arguments) --format csv -o $(RESULTS)/table$(suffix).csv
	@$(if $(missing),echo; echo 'No data in $(NCLT) for: $(missing)')
	@echo; cat $(RESULTS)/table$(suffix).md
	@echo 'Also as $(RESULTS)/table$(suffix).tex and .csv; what it means: docs/reproduction.md'

# An experiment with its own sessions, seeds and methods, unless the command line names others.
given          = $(if $(filter command% environment%,$(origin $(1))),$(2))
sweep_of       = $(call declared,$(EXPERIMENT)) $(both) \
                 $(call given,SESSIONS,--sessions $(call listed,$(SESSIONS))) \
                 $(call given,SEEDS,--seeds $(SEEDS)) $(call given,METHODS,--methods $(call listed,$(METHODS)))
collected      = $(RESULTS)/$(EXPERIMENT)$(suffix)/results.jsonl

sweep: $(EXPERIMENTS)
	@$(if $(EXPERIMENT),,echo 'Name an experiment: make sweep EXPERIMENT=regimes'; exit 1)
	$(marked)
	@# What could not be run is said, and fails in the end; what there is, is collected.
	@status=0; $(EXPERIMENTS) run $(sweep_of) --threads $(threads) || status=$$?; \
	  $(EXPERIMENTS) collect $(sweep_of) -o $(collected) && echo '  results in $(collected)' && exit $$status

regimes:
	@$(MAKE) --no-print-directory sweep EXPERIMENT=regimes

check-results: run
	@mkdir -p $(RESULTS)
	@$(EXPERIMENTS) check $(table_of) --methods $(call listed,$(methods)) --junit $(RESULTS)/check$(suffix).xml

accept-results: run
	@$(EXPERIMENTS) accept $(table_of) --methods $(call listed,$(methods))

stages: $(BIN)/.posecut-built
	@$(EXPERIMENTS) stages --programs $(BIN)
