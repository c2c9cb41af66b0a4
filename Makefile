# posecut: `make` alone prints help.

# ---- what to run ------------------------------------------------------------------------------------------
NCLT      ?=
SESSIONS  ?= 2012-01-22 2012-03-31 2012-08-04 2012-11-17
SEEDS     ?= 5
PIPELINES ?= paper calibrated
METHODS   ?= pcm pcm+gc
RESULTS   ?= results
SIMULATED ?= data/simulated

# ---- programs: swap a stage by naming another program -----------------------------------------------------
BIN       := $(or $(CARGO_TARGET_DIR),target)/release
SIMULATE  ?= $(BIN)/posecut-simulate
INGEST    ?= $(BIN)/posecut-ingest
CONSTRUCT ?= $(BIN)/posecut-construct
ORACLE    ?= $(BIN)/posecut-oracle
PCM       ?= $(BIN)/posecut-pcm
RANSAC    ?= $(BIN)/posecut-ransac
ISLANDS   ?= $(BIN)/posecut-islands
DENSEST   ?= $(BIN)/posecut-densest
VOTING    ?= $(BIN)/posecut-voting
MULTICUT  ?= $(BIN)/posecut-multicut
OPTIMIZE  ?= $(BIN)/posecut-optimize
EVALUATE  ?= $(BIN)/posecut-evaluate
REPORT    ?= $(BIN)/posecut-report

include pipelines/paper.mk pipelines/calibrated.mk

SHELL := /bin/sh
.DELETE_ON_ERROR:
.SECONDARY:
.SECONDEXPANSION:
.DEFAULT_GOAL := help
.PHONY: help table figures report test check bench data clean FORCE

help:
	@echo 'posecut: which landmark edges of a multi-session pose graph are wrong?'
	@echo
	@echo '  make table                     the table of the paper on simulated sessions, both regimes'
	@echo '  make table NCLT=DIR            the same on real NCLT sessions (DIR/DATE/ or DIR/DATE_sen.tar.gz)'
	@echo '       SESSIONS="2012-01-22 …"   which sessions      SEEDS=n       how many seeds'
	@echo '       PIPELINES="paper …"       which regimes       METHODS="…"   none pcm gc pcm+gc oracle,'
	@echo '                                 and to compare: ransac islands densest voting gnc dcs, each +gc too'
	@echo '  make figures [NCLT=DIR]        trajectories and optimised graphs, SVG and PNG'
	@echo '  make report [NCLT=DIR]         one HTML page: tables, maps, matrices, errors over time, regimes'
	@echo '  make test                      all tests'
	@echo '  make check                     formatting, lints, documentation'
	@echo '  make bench                     benchmarks'
	@echo '  make data [SESSIONS=…]         download NCLT sessions into data/nclt (large)'
	@echo '  make clean                     remove results and simulated sessions'
	@echo
	@echo 'Any stage can be another program: make table PCM=./my-stage. -j runs things in parallel.'

# ---- names ------------------------------------------------------------------------------------------------
suffix        := $(if $(NCLT),,-simulated)
experiments   := $(addsuffix $(suffix),$(PIPELINES))
source_of      = $(if $(NCLT),$(firstword $(wildcard $(NCLT)/$(1) $(NCLT)/$(1)_sen.tar.gz)),$(SIMULATED)/$(1))
present       := $(foreach session,$(SESSIONS),$(if $(call source_of,$(session)),$(session)))
missing       := $(filter-out $(present),$(SESSIONS))
seeds         := $(shell seq 1 $(SEEDS))
# results/EXPERIMENT/SESSION/SEED/FILE, taken apart
parts          = $(subst /, ,$(patsubst $(RESULTS)/%,%,$(1)))
experiment_of  = $(word 1,$(call parts,$(1)))
session_of     = $(word 2,$(call parts,$(1)))
seed_of        = $(word 3,$(call parts,$(1)))
options        = $($(patsubst %-simulated,%,$(call experiment_of,$@)).$(1))
# The experiment's options are those of our program: another one gets what the command line says for it, if anything.
declared       = $(patsubst %-simulated,%,$(call experiment_of,$@)).$(1)
own_options    = $(if $(filter $(BIN)/%,$(firstword $(2)))$(filter command,$(origin $(call declared,$(1)))),$(call options,$(1)))
said           = @printf '  %-9s %s\n' '$(1)' '$@'
results       := $(foreach experiment,$(experiments),$(foreach session,$(present),$(foreach seed,$(seeds),\
                 $(foreach method,$(METHODS),$(RESULTS)/$(experiment)/$(session)/$(seed)/$(method).result.json))))
comma         := ,
empty         :=
space         := $(empty) $(empty)
listed         = $(subst $(space),$(comma),$(strip $(1)))

# ---- programs ---------------------------------------------------------------------------------------------
sources       := $(shell find crates -name '*.rs' -o -name Cargo.toml) Cargo.toml Cargo.lock
binaries      := $(addprefix $(BIN)/posecut-,simulate ingest construct oracle pcm multicut optimize evaluate report convert \
                 ransac islands densest voting conform)

$(BIN)/.posecut-built: $(sources)
	@echo '  building the stages (the first time takes some minutes)'
	@cargo build --release --locked --bins --quiet
	@touch $@

# Cargo leaves a program alone that did not change, and so does Make what that program made.
$(binaries): $(BIN)/.posecut-built ;

# ---- sessions ---------------------------------------------------------------------------------------------
$(SIMULATED)/%/wheels.csv: $(SIMULATE)
	$(call said,simulate)
	@$(SIMULATE) --quiet --overwrite -o $(@D)

files_of       = $(if $(NCLT),$(wildcard $(call source_of,$(1)) $(call source_of,$(1))/*.csv),$(SIMULATED)/$(1)/wheels.csv)

# The settings of an experiment: a file that changes only when they do.
$(RESULTS)/%/settings: FORCE
	@mkdir -p $(@D)
	@printf '%s\n' 'source: $(if $(NCLT),$(NCLT),simulated)' 'ingest: $(call options,ingest)' 'construct: $(call options,construct)' \
	  'pcm: $(PCM) $(call options,pcm)' 'multicut: $(MULTICUT) $(call options,multicut)' \
	  'optimize: $(OPTIMIZE) $(call options,optimize)' 'evaluate: $(EVALUATE) $(call options,evaluate)' > $@.new
	@cmp -s $@.new $@ && rm $@.new || mv $@.new $@

$(RESULTS)/%/session.jsonl: $(INGEST) $$(call files_of,$$(call session_of,$$@)) $(RESULTS)/$$(call experiment_of,$$@)/settings
	$(call said,ingest)
	@mkdir -p $(@D)
	@$(INGEST) --quiet $(call source_of,$(call session_of,$@)) $(call options,ingest) -o $@ --stats $(@D)/ingest.stats.json

$(RESULTS)/%/graph.jsonl: $(CONSTRUCT) $$(dir $$(@D))session.jsonl
	$(call said,construct)
	@mkdir -p $(@D)
	@$(CONSTRUCT) --quiet $(dir $(@D))session.jsonl $(call options,construct) --seed $(call seed_of,$@) \
	  -o $@ --stats $(@D)/construct.stats.json

# ---- rejection --------------------------------------------------------------------------------------------
%/none.jsonl: %/graph.jsonl
	@cp $< $@

%/oracle.jsonl: %/graph.jsonl $(ORACLE)
	$(call said,oracle)
	@$(ORACLE) --quiet $< -o $@ --stats $(@D)/oracle.stats.json

%/pcm.jsonl: %/graph.jsonl $(PCM)
	$(call said,pcm)
	@$(PCM) --quiet $< $(call own_options,pcm,$(PCM)) -o $@ --stats $(@D)/pcm.stats.json

# Other methods, to compare with: their defaults, or options such as paper.ransac.
define rejection
%/$(1).jsonl: %/graph.jsonl $$($(2))
	$$(call said,$(1))
	@$$($(2)) --quiet $$< $(3) $$(call own_options,$(1),$$($(2))) -o $$@ --stats $$(@D)/$(1).stats.json
endef
$(eval $(call rejection,ransac,RANSAC))
$(eval $(call rejection,islands,ISLANDS))
$(eval $(call rejection,densest,DENSEST))
$(eval $(call rejection,voting,VOTING))
$(eval $(call rejection,gnc,OPTIMIZE,--gnc --reject-below 0.5))
$(eval $(call rejection,dcs,OPTIMIZE,--kernel-landmark dcs --reject-below 0.5))

%/gc.jsonl: %/graph.jsonl $(MULTICUT)
	$(call said,multicut)
	@$(MULTICUT) --quiet $< $(call own_options,multicut,$(MULTICUT)) -o $@ --stats $(@D)/gc.stats.json

%+gc.jsonl: %.jsonl $(MULTICUT)
	$(call said,multicut)
	@$(MULTICUT) --quiet $< $(call own_options,multicut,$(MULTICUT)) -o $@ --stats $*+gc.stats.json

# ---- optimisation and evaluation --------------------------------------------------------------------------
%.optimized.jsonl: %.jsonl $(OPTIMIZE)
	$(call said,optimize)
	@$(OPTIMIZE) --quiet $< $(call options,optimize) -o $@ --stats $*.optimize.stats.json

%.result.json: %.optimized.jsonl $$(@D)/oracle.optimized.jsonl $(EVALUATE)
	$(call said,evaluate)
	@$(EVALUATE) --quiet $< --reference $(@D)/oracle.optimized.jsonl $(call options,evaluate) \
	  --label pipeline=$(call experiment_of,$@) --label session=$(call session_of,$@) \
	  --label seed=$(call seed_of,$@) --label method=$(notdir $*) -o $@ --stats $*.evaluate.stats.json

# ---- table and figures ------------------------------------------------------------------------------------
table_arguments = $(results) --published pipelines/published.toml --methods $(call listed,$(METHODS)) \
                  $(if $(missing),--missing $(call listed,$(missing)))

table: $(results) $(REPORT)
	@$(if $(present),,echo 'No session of "$(SESSIONS)" has data in $(NCLT).'; exit 1)
	@mkdir -p $(RESULTS)
	@$(REPORT) table $(table_arguments) -o $(RESULTS)/table$(suffix).md
	@$(REPORT) table $(table_arguments) --format latex -o $(RESULTS)/table$(suffix).tex
	@$(REPORT) table $(table_arguments) --format csv -o $(RESULTS)/table$(suffix).csv
	@$(if $(missing),echo; echo 'No data in $(NCLT) for: $(missing)')
	@echo; cat $(RESULTS)/table$(suffix).md
	@echo 'Also as $(RESULTS)/table$(suffix).tex and .csv; what it means: docs/reproduction.md'

figure_names  := $(foreach experiment,$(experiments),$(RESULTS)/$(experiment)/trajectories \
                 $(foreach session,$(present),$(RESULTS)/$(experiment)/$(session)/1/graphs))
figures: $(addsuffix .svg,$(figure_names)) $(addsuffix .png,$(figure_names))
	@echo 'Figures under $(RESULTS)/: trajectories.svg, SESSION/1/graphs.svg (and .png)'

sessions_of    = $(foreach session,$(present),$(RESULTS)/$(call experiment_of,$(1))/$(session)/session.jsonl)

$(RESULTS)/%/trajectories.svg $(RESULTS)/%/trajectories.png: $$(call sessions_of,$$@) $(REPORT)
	$(call said,report)
	@$(REPORT) trajectories --quiet $(call sessions_of,$@) -o $(@D)/trajectories.svg
	@$(REPORT) trajectories --quiet $(call sessions_of,$@) -o $(@D)/trajectories.png

%/graphs.svg %/graphs.png: %/pcm.result.json %/pcm+gc.result.json $(REPORT)
	$(call said,report)
	@$(REPORT) graphs --quiet "PCM=$*/pcm.optimized.jsonl" "PCM+GC=$*/pcm+gc.optimized.jsonl" \
	  --reference $*/oracle.optimized.jsonl -o $*/graphs.svg
	@$(REPORT) graphs --quiet "PCM=$*/pcm.optimized.jsonl" "PCM+GC=$*/pcm+gc.optimized.jsonl" \
	  --reference $*/oracle.optimized.jsonl -o $*/graphs.png

# ---- one page -----------------------------------------------------------------------------------------------
# Regimes are put in where `make regimes` has left results.
regimes_found  = $(wildcard $(RESULTS)/regimes*/results.jsonl)

report: $(results) $(REPORT)
	@$(if $(present),,echo 'No session of "$(SESSIONS)" has data in $(NCLT).'; exit 1)
	@$(REPORT) html --quiet $(table_arguments) $(foreach file,$(regimes_found),--regimes $(file)) \
	  --title 'posecut: $(if $(NCLT),NCLT sessions,simulated sessions)' -o $(RESULTS)/report$(suffix).html
	@echo 'The page: $(RESULTS)/report$(suffix).html'

# ---- development ------------------------------------------------------------------------------------------
# The programs first: the contract tests run them. Optimised, because tests run real experiments, and because
# `make table` has built most of it already.
test:
	cargo build --release --workspace --bins --locked
	cargo test --release --workspace --locked

check:
	cargo fmt --all --check
	cargo clippy --workspace --all-targets --locked -- -D warnings
	RUSTDOCFLAGS="-D warnings" cargo doc --workspace --no-deps --locked

bench:
	cargo bench --workspace --locked

data:
	scripts/fetch-nclt.sh $(SESSIONS)

clean:
	rm -rf $(RESULTS) $(SIMULATED)
