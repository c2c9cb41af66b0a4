# The map of a laser log: keyframes with scans, landmark edges, their verdicts, optimised poses, a picture and a map for ROS. Beside it the
# map before (poses by odometry alone) and without rejection (all candidates in use): `make report` shows all three on its page.
#   make map                                              a simulated log
#   make map LOG=aces.clf.bz2 RELATIONS=aces.relations    a real one, and its errors
# INGEST, RECOGNIZE and VERIFY name other programs for the session, the landmark edges and their verdicts; RECOGNIZE=cat VERIFY=cat leaves
# the last two out. Other programs, another log or other relations than before redo the stages that depend on them.
LOG       ?=
RELATIONS ?=

map_log       := $(or $(LOG),$(RESULTS)/map/robot.log)
map_relations := $(or $(RELATIONS),$(if $(LOG),,$(RESULTS)/map/robot.relations))
map_place     := $(RESULTS)/map/$(firstword $(subst ., ,$(notdir $(map_log))))
ingesting     := $(or $(INGEST),$(BIN)/posecut-ingest)
# Without place recognition there are no landmark edges, and nothing to judge.
recognizing   := $(or $(RECOGNIZE),$(if $(filter recognize,$(programs)),$(BIN)/posecut-recognize,cat))
judging       := $(or $(VERIFY),$(if $(filter cat,$(recognizing)),cat,$(BIN)/posecut-verify))
# Without verdicts all candidates are in use anyway.
all_candidates := $(if $(filter cat,$(judging)),,$(map_place)/all-candidates)
map_errors     := $(if $(map_relations),$(map_place)/errors.result.json $(addsuffix .errors.result.json,$(map_place)/before $(all_candidates)))

# A graph optimised, drawn, and compared with relations. Only the map itself is written for ROS.
define optimized
$(call said,optimize)
@$(BIN)/posecut-optimize $< -o $@
endef

define drawn
$(call said,map)
@$(BIN)/posecut-map $< $(if $(filter map.png,$(@F)),--ros $(map_place)/map) -o $@
endef

# What a stage was given goes into a file that changes only if that does.
.PHONY: always
always: ;
define noted
$(marked)
@mkdir -p $(@D)
@printf '%s\n' '$(1)' | cmp -s - $@ || printf '%s\n' '$(1)' >$@
endef

$(map_place)/.ingest: always
	$(call noted,$(map_log) $(ingesting))

$(map_place)/.recognize: always
	$(call noted,$(recognizing))

$(map_place)/.verify: always
	$(call noted,$(judging))

$(map_place)/.relations: always
	$(call noted,$(map_relations))

define compared
$(call said,evaluate)
@$(BIN)/posecut-evaluate $< --relations $(map_relations) --trajectory $(map_place)/trajectory.tum -o $@
endef

ifeq ($(LOG),)
$(map_log): $(BIN)/posecut-simulate-log
	$(marked)
	@mkdir -p $(dir $@)
	$(call said,simulate)
	@$< --relations $(RESULTS)/map/robot.relations -o $@ -q

$(RESULTS)/map/robot.relations: $(map_log) ;
endif

$(map_place)/session.jsonl: $(map_log) $(ingesting) $(map_place)/.ingest
	$(call said,ingest)
	@$(ingesting) $< --scan-matching --trajectory $(map_place)/trajectory.tum -o $@

# Candidates of a simulated log get labels, which the page shows.
$(map_place)/graph.jsonl: $(map_place)/session.jsonl $(filter-out cat,$(recognizing)) $(map_place)/.recognize \
                         $(if $(LOG),,$(BIN)/posecut-label pipelines/laser-tolerance)
	$(call said,recognize)
	@$(recognizing) <$< >$@
	$(if $(LOG),,@$(BIN)/posecut-label $@ --ground-truth $< $$(cat pipelines/laser-tolerance) -q -o $@)

$(map_place)/judged.jsonl: $(map_place)/graph.jsonl $(filter-out cat,$(judging)) $(map_place)/.verify
	$(call said,judge)
	@$(judging) <$< >$@

$(map_place)/optimized.jsonl: $(map_place)/judged.jsonl $(BIN)/posecut-optimize
	$(optimized)

$(map_place)/all-candidates.jsonl: $(map_place)/graph.jsonl $(BIN)/posecut-optimize
	$(optimized)

$(map_place)/map.png: $(map_place)/optimized.jsonl $(BIN)/posecut-map
	$(drawn)

$(map_place)/before.png: $(map_place)/graph.jsonl $(BIN)/posecut-map
	$(drawn)

$(map_place)/all-candidates.png: $(map_place)/all-candidates.jsonl $(BIN)/posecut-map
	$(drawn)

$(map_place)/errors.result.json: $(map_place)/optimized.jsonl $(map_relations) $(map_place)/.relations $(BIN)/posecut-evaluate
	$(compared)

$(map_place)/before.errors.result.json: $(map_place)/graph.jsonl $(map_relations) $(map_place)/.relations $(BIN)/posecut-evaluate
	$(compared)

$(map_place)/all-candidates.errors.result.json: $(map_place)/all-candidates.jsonl $(map_relations) $(map_place)/.relations $(BIN)/posecut-evaluate
	$(compared)

.PHONY: map
map: $(addsuffix .png,$(map_place)/map $(map_place)/before $(all_candidates)) $(map_errors)
	@rm -f $(if $(all_candidates),,$(map_place)/all-candidates.*) $(if $(map_relations),,$(map_place)/*errors.result.json)
	@echo 'Map: $(map_place)/map.png; for ROS: $(map_place)/map.yaml'
	@echo 'By odometry alone: $(map_place)/before.png$(if $(all_candidates),; with all candidates in use: $(all_candidates).png)'
	@echo 'make report shows them on its page, with the accepted and the rejected edges'
