# The trust benchmark: every method on every kind of graph (pipelines/trust/*.toml, docs/trust.md).
#   make trust DATA=DIR [FAMILIES="clean kitti"] [SEEDS=1] [HALF=tuning|test] [DOCUMENT=FILE]
DATA          ?=
FAMILIES      ?= clean corrupted bicocca kitti kitti-zero robots two-experiences many-sessions hard
HALF          ?=
# The page is rewritten where all of the benchmark runs.
DOCUMENT      ?= $(if $(call given,FAMILIES,1)$(call given,SEEDS,1)$(call given,METHODS,1)$(HALF),,docs/trust.md)

trust_results  = $(RESULTS)/trust
trust_files    = $(wildcard $(foreach family,$(FAMILIES),$(foreach part,$(family) $(family)-real $(family)-simulated,\
                 pipelines/trust/$(part).toml)))
trust_unknown  = $(strip $(foreach family,$(FAMILIES),$(if $(wildcard pipelines/trust/$(family).toml pipelines/trust/$(family)-*.toml),,$(family))))
# The folder of data; drawn graphs need none.
trust_data     = $(or $(DATA),$(if $(filter-out drawn,$(FAMILIES)),,.))
trust_places   = --programs $(BIN) --simulated $(call quoted,$(SIMULATED)) $(if $(DATA),--data $(call quoted,$(DATA))) \
                 --results $(call quoted,$(trust_results))
trust_of       = $(trust_files) $(trust_places) $(swapped) $(if $(HALF),--half $(HALF)) \
                 $(call given,SEEDS,--seeds $(SEEDS)) $(call given,METHODS,--methods $(call listed,$(METHODS)))
# Figures of a page in docs: docs/results/PAGE-regret.svg.
trust_figures  = $(if $(DOCUMENT),docs/results/$(basename $(notdir $(DOCUMENT)))-,$(trust_results)/)
trust_figure   = $(trust_figures)regret.svg
trust_reliability = $(trust_figures)reliability.svg

.PHONY: trust-sample constants ablation pcm-gates

trust: $(if $(trust_data),$(EXPERIMENTS) $(REPORT))
	@test -n $(call quoted,$(trust_data)) || { echo 'Name the folder of graphs and sessions: make trust DATA=DIR. It holds'; \
	  echo '  g2o/             benchmark graphs (clean)'; \
	  echo '  false_closures/  corrupted/, bicocca25b/, kitti/, pcm_two_robots/ (corrupted, bicocca, kitti, kitti-zero, robots)'; \
	  echo '  nclt/DATE/       NCLT sessions (two-experiences, many-sessions, hard)'; \
	  echo '  radish/          laser logs (radish, which is not run by default)'; \
	  echo 'FAMILIES="clean kitti" needs those of these families alone; docs/methods.md says where to get them.'; \
	  echo 'FAMILIES=drawn needs no data: its graphs are simulated.'; exit 2; }
	@test -d $(call quoted,$(trust_data)) || { printf '%s: there is no such folder; name the one with g2o/, false_closures/ and nclt/\n' $(call quoted,$(DATA)); exit 2; }
	@$(if $(trust_unknown),echo 'No family is called $(trust_unknown); there are: $(sort $(patsubst %-real,%,$(patsubst %-simulated,%,$(filter-out methods sessions constants sample,$(basename $(notdir $(wildcard pipelines/trust/*.toml)))))))'; exit 2)
	$(marked)
	@mkdir -p $(call quoted,$(trust_results)) $(if $(DOCUMENT),docs/results)
	@# What could not be run is said, and fails in the end; what there is, is collected.
	@status=0; $(EXPERIMENTS) run $(trust_of) --threads $(threads) || status=$$?; \
	  $(EXPERIMENTS) collect $(trust_of) --quiet -o $(call quoted,$(trust_results)/results.jsonl) \
	    --times $(call quoted,$(trust_results)/times.jsonl) || status=$$?; \
	  $(REPORT) trust $(call quoted,$(trust_results)/results.jsonl) --times $(call quoted,$(trust_results)/times.jsonl) \
	    -o $(call quoted,$(trust_results)/trust.md) --figure $(call quoted,$(trust_figure)) \
	    --reliability $(call quoted,$(trust_reliability)) \
	    $(if $(HALF),--half $(HALF)) $(if $(DOCUMENT),--document $(call quoted,$(DOCUMENT))) \
	    $(if $(filter docs/trust.md,$(DOCUMENT)),--summary README.md) || status=$$?; exit $$status
	@echo '  tables in $(trust_results)/trust.md, one line a run in $(trust_results)/results.jsonl'

# A sample that needs no data, for tests of the whole chain: every method on two simulated sessions.
trust-sample: $(EXPERIMENTS) $(REPORT)
	@scripts/check-trust.sh $(call quoted,$(trust_results)-sample)

# What each ingredient of verification is worth: docs/results/verify-ablation.md. Shares its results with `make trust`.
ablated        = $(shell sed -n 's/^\(verify-without-[a-z-]*\) *= {.*/\1/p' pipelines/trust/methods.toml)
ablation_files = $(trust_files) $(filter-out $(trust_files),pipelines/trust/drawn.toml)
ablation_of    = $(ablation_files) $(trust_places) --methods $(call listed,none verify $(ablated))
ablation: $(EXPERIMENTS)
	@test -d $(call quoted,$(or $(DATA),missing)) || { echo 'Name the folder of graphs: make ablation DATA=DIR'; exit 2; }
	$(marked)
	@$(EXPERIMENTS) run $(ablation_of) --threads $(threads)
	@for half in tuning test; do \
	  $(EXPERIMENTS) collect $(ablation_of) --half $$half --quiet -o $(call quoted,$(trust_results))/ablation-$$half.jsonl && \
	  $(BIN)/xtask edges-table $(call quoted,$(trust_results))/ablation-$$half.jsonl --rows method --columns family \
	    --cell kept-lost-rmse -o docs/results/verify-ablation.md --section $$half || exit; done

# PCM's constants on the tuning halves: docs/results/constants.md.
constants_of   = pipelines/trust/constants.toml --half tuning $(trust_places)
constants: $(EXPERIMENTS)
	@test -d $(call quoted,$(or $(DATA),missing)) || { echo 'Name the folder of graphs: make constants DATA=DIR'; exit 2; }
	$(marked)
	@$(EXPERIMENTS) run $(constants_of) --threads $(threads)
	@$(EXPERIMENTS) collect $(constants_of) --quiet -o $(call quoted,$(trust_results)/constants.jsonl)
	@$(BIN)/xtask edges-table $(call quoted,$(trust_results)/constants.jsonl) --rows method,chance,grow --cell kept-lost-rmse \
	  --columns 'clean=[iM][nI]*' 'corrupted=csail_*' 'bicocca=B25b_*' 'kitti=kitti_05_*' 'sessions=20*' \
	  -o docs/results/constants.md --section constants

# PCM's options on graphs with false closures: docs/results/pcm.md.
gates_of       = pipelines/pcm-gates.toml --programs $(BIN) --data $(call quoted,$(DATA)) --results $(call quoted,$(RESULTS))
pcm-gates: $(EXPERIMENTS)
	@test -d $(call quoted,$(or $(DATA),missing)) || { echo 'Name the folder of graphs: make pcm-gates DATA=DIR'; exit 2; }
	$(marked)
	@$(EXPERIMENTS) run $(gates_of) --threads $(threads)
	@$(EXPERIMENTS) collect $(gates_of) --quiet -o $(call quoted,$(RESULTS)/pcm-gates/results.jsonl)
	@$(BIN)/xtask edges-table $(call quoted,$(RESULTS)/pcm-gates/results.jsonl) --rows session --columns method \
	  -o docs/results/pcm.md --section data
