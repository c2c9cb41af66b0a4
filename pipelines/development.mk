# Tests, checks, generated documents, installation, data.
# The contract tests run the programs, so these are built too, at once. Optimised, because tests run real experiments,
# and because `make table` has built most of it already. Of the examples, tests run two and CI two more; `make check` compiles all.
# Many tests wait for programs that they started: with two tests a processor, no processor waits with them.
test:
	scripts/check-makefile.sh
	cargo build --release --workspace --bins --tests --example failing_calls --example planted --example fuzz --example pages --locked
	RUST_TEST_THREADS=$${RUST_TEST_THREADS:-$$((2 * $$(getconf _NPROCESSORS_ONLN)))} \
		cargo test --release --workspace --tests --locked
	cargo test --release --workspace --doc --locked

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
