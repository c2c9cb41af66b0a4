# posecut: `make` alone prints help.

# ---- what to run ------------------------------------------------------------------------------------------
NCLT      ?=
SESSIONS  ?= 2012-01-22 2012-03-31 2012-08-04 2012-11-17
SEEDS     ?= 5
PIPELINES ?= paper calibrated
METHODS   ?= pcm pcm+gc
RESULTS   ?= results
SIMULATED ?= data/simulated

# ---- names that could become commands ---------------------------------------------------------------------
# These names become parts of command lines, of file names and of rules, none of which can hold every character. They are
# refused before anything is expanded: $(value) is what was written.
define newline


endef
empty         :=
space         := $(empty) $(empty)
tab           := $(empty)	$(empty)
open          := (
close         := )
marks         := ; & | < > $(open) $(close) ' " ` \ * ? [ ] { } ! \# : = % $$
cannot         = $(error $(1) cannot be used: $(2); name it with letters, digits and . _ - + / alone)
plain          = $(foreach mark,$(marks),$(if $(findstring $(mark),$(value $(1))),$(call cannot,$(1),it contains $(mark))))\
                 $(if $(findstring $(newline),$(value $(1))),$(call cannot,$(1),it contains the end of a line))\
                 $(if $(filter -%,$(value $(1))),$(call cannot,$(1),it starts with a dash))
one            = $(if $(or $(findstring $(space),$(value $(1))),$(findstring $(tab),$(value $(1)))),$(call cannot,$(1),it contains a space))
given_folder   = $(if $(strip $(value $(1))),,$(call cannot,$(1),it is empty))
# A variable that nobody gives has its own value, which may be made of others.
foreign        = $(filter environment% command% override,$(origin $(1)))
folders       := NCLT RESULTS SIMULATED $(foreach name,DATA DOCUMENT PREFIX,$(if $(call foreign,$(name)),$(name)))
words         := SESSIONS $(foreach name,SEEDS PIPELINES METHODS FAMILIES HALF EXPERIMENT FIGURES CASES,$(if $(call foreign,$(name)),$(name)))
checked       := $(foreach name,$(folders) $(words),$(call plain,$(name)))\
                 $(foreach name,$(folders),$(call one,$(name)))\
                 $(foreach name,RESULTS SIMULATED $(if $(call foreign,PREFIX),PREFIX),$(call given_folder,$(name)))\
                 $(if $(findstring /,$(value SESSIONS)),$(call cannot,SESSIONS,a session contains /))

# ---- programs: swap a stage by naming another program -----------------------------------------------------
# Every crate with a main.rs is one, except what maintainers run. To swap a stage for this run: make table PCM=./my-stage
programs   := $(filter-out xtask,$(patsubst crates/%/src/main.rs,%,$(wildcard crates/*/src/main.rs)))
stages     := $(shell echo $(filter-out posecut conform experiment inspect report,$(programs)) | tr a-z A-Z)
# Paths of programs become parts of rules and command lines, like the names above.
checked       += $(foreach name,BIN CARGO_TARGET_DIR REPORT $(stages),$(if $(call foreign,$(name)),\
                 $(call plain,$(name))$(call one,$(name))))
BIN        := $(or $(CARGO_TARGET_DIR),target)/release
EXPERIMENTS = $(BIN)/posecut-experiment
REPORT     ?= $(BIN)/posecut-report

SHELL := /bin/sh
.DELETE_ON_ERROR:
.SECONDARY:
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
	@echo '  make report [NCLT=DIR]         one HTML page: tables, maps, matrices, errors over time, regimes'
	@echo '  make sweep EXPERIMENT=NAME     any experiment declared in pipelines/NAME.toml'
	@echo '  make regimes [NCLT=DIR]        the map of where graph cuts help (long; resumes where it stopped)'
	@echo '  make check-results [NCLT=DIR]  compare the table with pipelines/expected.toml'
	@echo '  make accept-results [NCLT=DIR] record the table there, and show the changes'
	@echo '  make stages                    the stage programs and their versions'
	@echo '  make online [NCLT=DIR]         online rejection: edges added and retracted while the map grows, SVG'
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

# ---- experiments ------------------------------------------------------------------------------------------
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

# ---- figures ----------------------------------------------------------------------------------------------
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
# Regimes and the trust benchmark are put in where `make regimes` and `make trust` have left results.
report: run $(REPORT)
	@$(REPORT) html --quiet $(table_arguments) $(foreach file,$(maps_found),--regimes $(file)) \
	  $(addprefix --trust ,$(wildcard $(RESULTS)/trust/results.jsonl)) \
	  --title 'posecut: $(if $(NCLT),NCLT sessions,simulated sessions)' -o $(RESULTS)/report$(suffix).html
	@echo 'The page: $(RESULTS)/report$(suffix).html'

include pipelines/online.mk

include pipelines/trust.mk

# ---- development ------------------------------------------------------------------------------------------
# The contract tests run the programs, so these are built too, at once. Optimised, because tests run real experiments,
# and because `make table` has built most of it already.
test:
	scripts/check-makefile.sh
	cargo build --release --workspace --bins --tests --examples --locked
	cargo test --release --workspace --locked

# Property tests on other cases than those that every run of the tests draws: make properties CASES="7 8 9".
CASES ?= 2 3 4
properties:
	for case in $(CASES); do echo "cases $$case"; PROPTEST_RNG_SEED=$$case cargo test --release --workspace --locked --quiet || exit 1; done

check:
	cargo fmt --all --check
	cargo clippy --workspace --all-targets --locked -- -D warnings
	RUSTDOCFLAGS="-D warnings" cargo doc --workspace --no-deps --locked

documentation:
	cargo build --release --workspace --bins --locked
	cargo xtask documentation
	cargo xtask licences

# Programs, manual pages and completions below PREFIX.
PREFIX ?= $(HOME)/.local
prefix  = $(call quoted,$(PREFIX))
installed := $(BIN)/posecut $(addprefix $(BIN)/posecut-,$(filter-out posecut,$(programs)))
install: $(BIN)/.posecut-built
	@mkdir -p $(prefix)/bin $(prefix)/share/man/man1 $(prefix)/share/bash-completion/completions \
	  $(prefix)/share/zsh/site-functions $(prefix)/share/fish/vendor_completions.d
	@for program in $(installed); do name=$$(basename $$program); \
	  install -m 755 $$program $(prefix)/bin/ && \
	  $$program --generate man  > $(prefix)/share/man/man1/$$name.1 && \
	  $$program --generate bash > $(prefix)/share/bash-completion/completions/$$name && \
	  $$program --generate zsh  > $(prefix)/share/zsh/site-functions/_$$name && \
	  $$program --generate fish > $(prefix)/share/fish/vendor_completions.d/$$name.fish || exit 1; done
	@printf 'installed programs, manual pages and completions below %s\n' $(prefix)

bench:
	cargo bench --workspace --locked

data:
	scripts/fetch-nclt.sh $(SESSIONS)

clean:
	@scripts/folders.sh clean $(call quoted,$(RESULTS)) $(call quoted,$(SIMULATED))
