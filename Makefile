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
# Every crate with a main.rs is one, except what maintainers run. To swap a stage for this run: make table PCM=./my-stage
programs   := $(filter-out xtask,$(patsubst crates/%/src/main.rs,%,$(wildcard crates/*/src/main.rs)))
stages     := $(shell echo $(filter-out posecut conform experiment inspect report,$(programs)) | tr a-z A-Z)
# Refuses names that could become commands, before any is used.
include pipelines/names.mk
BIN        := $(or $(CARGO_TARGET_DIR),target)/release
EXPERIMENTS = $(BIN)/posecut-experiment
REPORT     ?= $(BIN)/posecut-report

SHELL := /bin/sh
.DELETE_ON_ERROR:
.DEFAULT_GOAL := help
.PHONY: help trust documentation install table methods figures report regimes sweep run check-results accept-results stages test check properties bench data clean

help:
	@echo 'posecut: which landmark edges of a multi-session pose graph are wrong?'
	@echo
	@echo '  make table                     the table of the paper on simulated sessions, in both regimes'
	@echo '  make table NCLT=DIR            the same on real NCLT sessions (DIR/DATE/ or DIR/DATE_sen.tar.gz)'
	@echo '       SESSIONS="2012-01-22 …"   which sessions      SEEDS=n       how many seeds'
	@echo '       PIPELINES="paper …"       which regimes       METHODS="…"   none pcm gc pcm+gc oracle,'
	@echo '                                 for comparison: pcm-chance ransac islands densest voting gnc dcs,'
	@echo '                                 each also with +gc'
	@echo '  make trust DATA=DIR            every method on every kind of graph: docs/trust.md (half an hour; resumes)'
	@echo '       FAMILIES="clean kitti"    which families      HALF=test       one half'
	@echo '  make trust-sample              every method on two simulated sessions, without data (half a minute)'
	@echo '  make ablation DATA=DIR         what each part of posecut-verify contributes: docs/results/verify-ablation.md'
	@echo '  make constants DATA=DIR        PCM'"'"'s constants on the tuning halves: docs/results/constants.md'
	@echo '  make pcm-gates DATA=DIR        PCM'"'"'s options on graphs with false closures: docs/results/pcm.md'
	@echo '  make figures [NCLT=DIR]        trajectories, graphs, consistency, components, errors, regimes; SVG and PNG'
	@echo '  make report [NCLT=DIR]         one HTML page: tables, maps, matrices, errors over time, regimes, laser logs'
	@echo '  make sweep EXPERIMENT=NAME     any experiment declared in pipelines/NAME.toml'
	@echo '  make regimes [NCLT=DIR]        the map of where graph cuts help (long; resumes where it stopped)'
	@echo '  make check-results [NCLT=DIR]  compare the table with pipelines/expected.toml'
	@echo '  make accept-results [NCLT=DIR] record the table there, and show the changes'
	@echo '  make stages                    the stage programs and their versions'
	@echo '  make online [NCLT=DIR]         online rejection: edges added and retracted while the map grows, SVG'
	@echo '  make map [LOG=FILE]            the map of a laser log (CARMEN format), by default a simulated one: PNG, and for ROS;'
	@echo '                                 beside it before and with all candidates; make report shows them'
	@echo '       RELATIONS=FILE            and its errors against relations measured by hand'
	@echo '  make test                      all tests'
	@echo '  make check                     formatting, lints, documentation'
	@echo '  make documentation             regenerate docs/cli.md, option tables and schema from the programs'
	@echo '  make install [PREFIX=DIR]      programs, manual pages and shell completions'
	@echo '  make bench                     benchmarks'
	@echo '  make data [SESSIONS=…]         download NCLT sessions into data/nclt (large)'
	@echo '  make clean                     remove results and simulated sessions that a run created'
	@echo
	@echo 'Any stage can be another program: make table PCM=./my-stage. -j runs things in parallel.'

# ---- names ------------------------------------------------------------------------------------------------
suffix        := $(if $(NCLT),,-simulated)
experiments   := $(addsuffix $(suffix),$(PIPELINES))
source_of      = $(if $(NCLT),$(firstword $(wildcard $(NCLT)/$(1) $(NCLT)/$(1)_sen.tar.gz)),$(SIMULATED)/$(1))
present       := $(foreach session,$(SESSIONS),$(if $(call source_of,$(session)),$(session)))
missing       := $(filter-out $(present),$(SESSIONS))
said           = @printf '  %-9s %s\n' '$(1)' '$@'
comma         := ,
listed         = $(subst $(space),$(comma),$(strip $(1)))
# Notes which folders a run made, for `make clean`.
marked         = @scripts/folders.sh mark $(call quoted,$(RESULTS)) $(call quoted,$(SIMULATED))
declared       = $(foreach name,$(1),pipelines/$(name).toml)

# ---- what the runner of experiments is told ---------------------------------------------------------------
# As many tasks at once as -j allows, or as there are processors.
threads        = $(or $(patsubst -j%,%,$(filter -j%,$(MAKEFLAGS))),0)
quoted         = '$(subst ','\'',$(1))'
places         = --programs $(BIN) --simulated $(call quoted,$(SIMULATED)) --results $(call quoted,$(RESULTS)) \
                 $(if $(NCLT),--nclt $(call quoted,$(NCLT)))
swapped        = $(foreach stage,$(stages),$(if $($(stage)),--program $(shell echo $(stage) | tr A-Z a-z)=$($(stage))))
# make table 'paper.pcm=--probability 0.95'
settings       = $(foreach name,$(filter $(addsuffix .%,$(PIPELINES) $(EXPERIMENT) regimes),$(.VARIABLES)),\
                 --set $(call quoted,$(name)=$($(name))))
both           = $(places) $(swapped) $(settings)
# A figure shows these two methods, whichever the table has.
methods       := $(METHODS) $(if $(filter figures,$(MAKECMDGOALS)),$(filter-out $(METHODS),pcm pcm+gc))
table_of       = $(call declared,$(PIPELINES)) $(both) --sessions $(call listed,$(SESSIONS)) --seeds $(SEEDS)

# ---- programs ---------------------------------------------------------------------------------------------
sources       := $(shell find crates -name '*.rs' -o -name Cargo.toml -o -path '*/assets/*' -type f) Cargo.toml Cargo.lock
$(BIN)/.posecut-built: $(sources)
	@echo '  building the stages (the first time takes some minutes)'
	@cargo build --release --locked --bins --quiet
	@touch $@

# Cargo leaves a program alone that did not change, and so does Make what that program made.
$(BIN)/posecut-%: $(BIN)/.posecut-built ;

# ---- rules ------------------------------------------------------------------------------------------------
include pipelines/table.mk pipelines/figures.mk pipelines/online.mk pipelines/map.mk pipelines/trust.mk pipelines/development.mk
