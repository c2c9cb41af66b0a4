# Figures, and one page with everything.
# FIGURES="svg png pdf"; PDF where posecut-report is built with the feature of that name.
FIGURES       ?= svg png
of_a_session   = graphs consistency components error
maps_found     = $(wildcard $(RESULTS)/regimes*/results.jsonl)
figure_names  := $(foreach experiment,$(experiments),$(RESULTS)/$(experiment)/trajectories \
                 $(foreach session,$(present),$(addprefix $(RESULTS)/$(experiment)/$(session)/1/,$(of_a_session)))) \
                 $(foreach map,$(dir $(maps_found)),$(addprefix $(map),map differences curves))
figures: $(foreach format,$(FIGURES),$(addsuffix .$(format),$(figure_names)))
	@echo 'Figures under $(RESULTS)/ ($(FIGURES)): trajectories; SESSION/1/: $(of_a_session)$(if $(maps_found),; regimes: map differences curves)'

# A rule for each format, since each is drawn by itself.
define figures_as
$$(RESULTS)/%/trajectories.$(1): run $$(REPORT)
	@$$(REPORT) trajectories --quiet $$(foreach session,$$(present),$$(@D)/$$(session)/session.jsonl) -o $$@

%/graphs.$(1): run $$(REPORT)
	@$$(REPORT) graphs --quiet "PCM=$$*/pcm.optimized.jsonl" "PCM+GC=$$*/pcm+gc.optimized.jsonl" \
	  --reference $$*/oracle.optimized.jsonl -o $$@

%/consistency.$(1): run $$(REPORT)
	@$$(REPORT) consistency --quiet "PCM=$$*/pcm.jsonl" -o $$@

%/components.$(1): run $$(REPORT)
	@$$(REPORT) components --quiet "PCM+GC=$$*/pcm+gc.optimized.jsonl" -o $$@

%/error.$(1): run $$(REPORT)
	@$$(REPORT) error --quiet "PCM=$$*/pcm.optimized.jsonl" "PCM+GC=$$*/pcm+gc.optimized.jsonl" \
	  --reference $$*/oracle.optimized.jsonl -o $$@

%/map.$(1): %/results.jsonl $$(REPORT)
	@$$(REPORT) regimes --quiet $$< -o $$@

%/differences.$(1): %/results.jsonl $$(REPORT)
	@$$(REPORT) regimes --quiet --show differences $$< -o $$@

%/curves.$(1): %/results.jsonl $$(REPORT)
	@$$(REPORT) regimes --quiet --show curves $$< -o $$@
endef
$(foreach format,$(FIGURES),$(eval $(call figures_as,$(format))))

# ---- one page -----------------------------------------------------------------------------------------------
# Maps of laser logs, regimes and the trust benchmark are put in where `make map`, `make regimes` and `make trust` have left results.
report: run $(REPORT)
	@$(REPORT) html --quiet $(table_arguments) $(foreach file,$(maps_found),--regimes $(file)) \
	  $(addprefix --map ,$(patsubst %/optimized.jsonl,%,$(sort $(wildcard $(RESULTS)/map/*/optimized.jsonl)))) \
	  $(addprefix --trust ,$(wildcard $(RESULTS)/trust/results.jsonl)) \
	  --title 'posecut: $(if $(NCLT),NCLT sessions,simulated sessions)' -o $(RESULTS)/report$(suffix).html
	@echo 'The page: $(RESULTS)/report$(suffix).html'
