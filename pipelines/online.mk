# Online rejection: a session of pipelines/online.toml comes pose by pose; PCM and the multicut decide every ONLINE_EVERY poses,
# and edges go into the map or are taken back. The figure shows the map's error over time beside batch solutions.
#   make online                                              a simulated session
#   make online NCLT=data/nclt SESSIONS=2012-08-04           a real one
ONLINE_EVERY ?= 20
ONLINE       ?= $(BIN)/examples/online_rejection

$(BIN)/examples/online_rejection: $(sources) $(wildcard crates/isam/examples/*.rs)
	@cargo build --release --locked --quiet --workspace --example online_rejection
	@touch $@

online_session := $(firstword $(present))
online_place   := $(RESULTS)/online$(suffix)/$(online_session)/1

.PHONY: online
online: $(EXPERIMENTS) $(ONLINE)
	@$(if $(present),,echo 'No session of "$(SESSIONS)" has data in $(NCLT).'; exit 1)
	$(marked)
	@$(EXPERIMENTS) run pipelines/online.toml $(both) --sessions $(online_session) --threads $(threads)
	@$(ONLINE) $(online_place)/graph.jsonl $(online_place)/online.svg $(online_place)/online.csv $(ONLINE_EVERY)
	@echo 'Figure and series: $(online_place)/online.svg, $(online_place)/online.csv'
