# Online rejection: the first session of the experiment comes pose by pose; PCM and the multicut decide every ONLINE_EVERY
# poses, and edges go into the map or are taken back. The figure shows the map's error over time beside batch solutions.
#   make online                                              a simulated session
#   make online NCLT=data/nclt SESSIONS=2012-08-04           a real one
ONLINE_EVERY ?= 20
ONLINE       ?= $(BIN)/examples/online_rejection

$(BIN)/examples/online_rejection: $(sources) $(wildcard crates/optimize/examples/*.rs)
	@cargo build --release --locked --quiet -p posecut-optimize --example online_rejection
	@touch $@

%/online.svg: %/graph.jsonl $(ONLINE)
	$(call said,online)
	@$(ONLINE) $< $*/online.svg $*/online.csv $(ONLINE_EVERY)

.PHONY: online
online: $(foreach session,$(firstword $(present)),$(RESULTS)/paper$(suffix)/$(session)/1/online.svg)
	@echo 'Figure and series: $<, $(<:.svg=.csv)'
