# The map of a laser log: keyframes with scans, landmark edges, their verdicts, optimised poses, a picture and a map for ROS.
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

$(map_place)/graph.jsonl: $(map_place)/session.jsonl $(filter-out cat,$(recognizing))
	$(call said,recognize)
	@$(recognizing) <$< >$@

$(map_place)/judged.jsonl: $(map_place)/graph.jsonl $(filter-out cat,$(judging))
	$(call said,judge)
	@$(judging) <$< >$@

$(map_place)/optimized.jsonl: $(map_place)/judged.jsonl $(BIN)/posecut-optimize
	$(call said,optimize)
	@$(BIN)/posecut-optimize $< -o $@

$(map_place)/map.png: $(map_place)/optimized.jsonl $(BIN)/posecut-map
	$(call said,map)
	@$(BIN)/posecut-map $< --ros $(map_place)/map -o $@

$(map_place)/errors.result.json: $(map_place)/optimized.jsonl $(map_relations) $(BIN)/posecut-evaluate
	$(call said,evaluate)
	@$(BIN)/posecut-evaluate $< --relations $(map_relations) --trajectory $(map_place)/trajectory.tum -o $@

.PHONY: map
map: $(map_place)/map.png $(if $(map_relations),$(map_place)/errors.result.json)
	@echo 'Map: $(map_place)/map.png; for ROS: $(map_place)/map.yaml'
