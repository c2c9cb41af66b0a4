# Names that could become commands.
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
folders       := NCLT RESULTS SIMULATED $(foreach name,DATA DOCUMENT PREFIX LOG RELATIONS,$(if $(call foreign,$(name)),$(name)))
words         := SESSIONS $(foreach name,SEEDS PIPELINES METHODS FAMILIES HALF EXPERIMENT FIGURES CASES,$(if $(call foreign,$(name)),$(name)))
checked       := $(foreach name,$(folders) $(words),$(call plain,$(name)))\
                 $(foreach name,$(folders),$(call one,$(name)))\
                 $(foreach name,RESULTS SIMULATED $(if $(call foreign,PREFIX),PREFIX),$(call given_folder,$(name)))\
                 $(if $(findstring /,$(value SESSIONS)),$(call cannot,SESSIONS,a session contains /))

# Paths of programs become parts of rules and command lines, like the names above.
checked       += $(foreach name,BIN CARGO_TARGET_DIR REPORT $(stages),$(if $(call foreign,$(name)),\
                 $(call plain,$(name))$(call one,$(name))))
