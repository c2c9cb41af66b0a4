# The map of a laser log: keyframes with scans, landmark edges, their verdicts, optimised poses, a picture and a map for ROS. Beside it the
# map before (poses by odometry alone) and without rejection (all candidates in use): `make report` shows all three on its page.
#   make map                                              a simulated log
#   make map LOG=aces.clf.bz2 RELATIONS=aces.relations    a real one, and its errors
# RECOGNIZE and VERIFY name other programs for the landmark edges and their verdicts; RECOGNIZE=cat VERIFY=cat leaves both out.
LOG       ?=
RELATIONS ?=

map_log       := $(or $(LOG),$(RESULTS)/map/robot.log)
map_relations := $(or $(RELATIONS),$(if $(LOG),,$(RESULTS)/map/robot.relations))
map_place     := $(RESULTS)/map/$(firstword $(subst ., ,$(notdir $(map_log))))
# Without place recognition there are no landmark edges, and nothing to judge.
recognizing   := $(or $(RECOGNIZE),$(if $(filter recognize,$(programs)),$(BIN)/posecut-recognize,cat))
judging       := $(or $(VERIFY),$(if $(filter cat,$(recognizing)),cat,$(BIN)/posecut-verify))
# Candidates of a simulated log get labels, which the page shows: how far a correct one may be off, metres and degrees.
close_enough  := --tolerance-translation 0.5 --tolerance-rotation 5.73
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

$(map_place)/session.jsonl: $(map_log) $(BIN)/posecut-ingest
	$(marked)
	@mkdir -p $(map_place)
	$(call said,ingest)
	@$(BIN)/posecut-ingest $< --scan-matching --trajectory $(map_place)/trajectory.tum -o $@

$(map_place)/graph.jsonl: $(map_place)/session.jsonl $(filter-out cat,$(recognizing)) $(if $(LOG),,$(BIN)/posecut-label)
	$(call said,recognize)
	@$(recognizing) <$< >$@
	$(if $(LOG),,@$(BIN)/posecut-label $@ --ground-truth $< $(close_enough) -q -o $@)

$(map_place)/judged.jsonl: $(map_place)/graph.jsonl $(filter-out cat,$(judging))
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

$(map_place)/errors.result.json: $(map_place)/optimized.jsonl $(map_relations) $(BIN)/posecut-evaluate
	$(compared)

$(map_place)/before.errors.result.json: $(map_place)/graph.jsonl $(map_relations) $(BIN)/posecut-evaluate
	$(compared)

$(map_place)/all-candidates.errors.result.json: $(map_place)/all-candidates.jsonl $(map_relations) $(BIN)/posecut-evaluate
	$(compared)

.PHONY: map
map: $(addsuffix .png,$(map_place)/map $(map_place)/before $(all_candidates)) $(map_errors)
	@echo 'Map: $(map_place)/map.png; for ROS: $(map_place)/map.yaml'
	@echo 'By odometry alone: $(map_place)/before.png$(if $(all_candidates),; with all candidates in use: $(all_candidates).png)'
	@echo 'make report shows them on its page, with the accepted and the rejected edges'
