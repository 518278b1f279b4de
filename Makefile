# `make test` is all there is to checking a change; CI runs the same.
CARGO ?= cargo
PYTHON ?= python3
VENV := .venv
PIP := $(VENV)/bin/python -m pip --quiet --disable-pip-version-check

# Where `make install` puts libfric: `PREFIX=$HOME/.local` needs no root, /usr/local does (`sudo --preserve-env=PATH make install
# && sudo ldconfig`). Packages are built with DESTDIR. PROFILE=dev is what the tests install.
PREFIX ?= /usr/local
DESTDIR ?=
PROFILE ?= release
TARGET := $(or $(CARGO_TARGET_DIR),target)

# A machine without operating system, and one that Miri can interpret: x86_64's roots are assembly to it.
BARE_METAL := thumbv7em-none-eabihf
MIRI_TARGET := riscv64gc-unknown-linux-gnu

# What `make test` does: first what uses every processor, the tools before all, so that what is missing shows at once; then, two at a time, what uses one.
STEPS := tools format lint test-rust docs
PAIRED := test-python miri instructions bare-metal

.PHONY: test soak check format lint test-rust docs test-python instructions bare-metal miri bench install install-cli tools coverage notices deny book
.PHONY: wheel release platforms python-package

# Cargo would look for the job server of a make that runs two steps at a time, which only a sub-make may use.
unexport MAKEFLAGS MFLAGS

# In the end, where the time went. What a paired step prints appears when it has ended.
test:
	@set -e; times=; timed() { name=$$1; shift; start=$$(date +%s); $(MAKE) --no-print-directory "$$@"; times="$$times$$name $$(($$(date +%s) - start))\n"; }; \
	for step in $(STEPS); do timed $$step $$step; done; \
	timed "$(PAIRED), two at a time:" --jobs=2 --output-sync=target $(PAIRED); \
	printf "\nseconds of each step\n$$times"

# What takes too long for every change, an hour or so: the tests marked for it, and random robots in random motion (see ASSURANCE.md).
SOAK_CYCLES ?= 100000000
soak: tools
	$(CARGO) test --workspace --quiet -- --ignored
	$(CARGO) run --release --quiet -p fric-core --example soak -- $(SOAK_CYCLES) 1 2
	$(CARGO) run --release --quiet -p fric-core --example soak -- $(SOAK_CYCLES) 1 2 adversary

# While working: formatting, lints and the tests within the crates, without those that run whole programs or long simulations.
check: format lint
	$(CARGO) test --workspace --lib --quiet

tools:
	$(PYTHON) tests/python/tools.py

# `cargo fmt` does not see the files of the effects, which a macro names.
format:
	$(CARGO) fmt --all --check
	$(CARGO) fmt --manifest-path fuzz/Cargo.toml --check
	rustfmt --check crates/*/src/effects/*.rs

lint:
	$(CARGO) clippy --workspace --all-targets --quiet -- -D warnings
	$(CARGO) clippy --manifest-path fuzz/Cargo.toml --no-default-features --target-dir target --quiet -- -D warnings

test-rust:
	$(CARGO) test --workspace --quiet

docs:
	RUSTDOCFLAGS="-D warnings" $(CARGO) doc --workspace --no-deps --quiet

test-python: python-package
	$(VENV)/bin/python -m pytest -rs tests/python

python-package: $(VENV)/ready
	# The command line as the tests in Rust have built it; alone, cargo would build all of it again with other features of dependencies.
	$(CARGO) test --workspace --no-run --quiet
	# As `pip install .` does, but with what has been built for the other tests.
	PATH="$(CURDIR)/$(VENV)/bin:$$PATH" MATURIN_PEP517_ARGS="--profile dev" $(PIP) install --no-build-isolation --no-deps .

$(VENV)/ready: tests/python/requirements.txt | tools
	$(PYTHON) -m venv $(VENV)
	$(PIP) install -r tests/python/requirements.txt
	touch $@

instructions: tools
	benches/instructions.sh

bare-metal:
	@if rustup target add $(BARE_METAL) >/dev/null 2>&1; then \
		$(CARGO) build --quiet --release -p fric-core -p fric-tendon --target $(BARE_METAL) && \
		$(CARGO) build --quiet --release -p fric-core -p fric-tendon --features fric-core/alloc,fric-tendon/alloc --target $(BARE_METAL) && \
		echo "fric-core and fric-tendon build for $(BARE_METAL)"; \
	else echo "not checked: fric-core and fric-tendon on bare metal; rustup cannot add $(BARE_METAL)"; fi

miri:
	@if rustup component add miri rust-src --toolchain nightly >/dev/null 2>&1; then \
		$(CARGO) +nightly miri test --quiet -p fric-capi --test main --target $(MIRI_TARGET); \
	else echo "not checked: the C interface under Miri; rustup cannot add miri and rust-src to the nightly toolchain"; fi

install:
	library=$$(CARGO="$(CARGO)" packaging/built.sh "$(PROFILE)" fric-capi libfric.so) && \
	PREFIX="$(PREFIX)" DESTDIR="$(DESTDIR)" crates/fric-capi/packaging/install.sh "$${library%/*}"

# The command line with its manual pages and completions. Where the directories are not on a path yet, the last line says so.
install-cli:
	program=$$(CARGO="$(CARGO)" packaging/built.sh "$(PROFILE)" fric-cli fric-cli) && \
	PREFIX="$(PREFIX)" DESTDIR="$(DESTDIR)" packaging/install-cli.sh "$$program"

# The book, with every effect drawn, into target/book.
book: python-package
	$(VENV)/bin/python docs/tools/book.py "$(TARGET)/book"

# Wheels and source distribution into target/wheels, tried in an environment without Rust.
wheel:
	packaging/wheel.sh "$(TARGET)/wheels"

# A replay on aarch64 has the bits of one on x86-64, and the command line builds for Windows.
platforms:
	PROFILE="$(PROFILE)" packaging/platforms.sh

# All of a release that publishes nothing, after `make test`: checks, packages of the crates, wheels, the tag.
release:
	packaging/release.sh

bench:
	$(CARGO) bench

# Lines and branches of core, tendon, log and C interface that their own tests reach. Some 12 minutes; needs `cargo install cargo-llvm-cov` and
# `rustup component add llvm-tools --toolchain nightly`.
coverage:
	$(CARGO) +nightly llvm-cov --branch -p fric-core -p fric-tendon -p fric-log -p fric-capi --all-features --quiet --summary-only

# Licences of what is built in, for who passes binaries on; needs `cargo install cargo-about --features cli`.
notices:
	$(CARGO) about generate --locked --workspace about.hbs -o THIRD-PARTY.txt
	sed -i '/^  fric-/d' THIRD-PARTY.txt

# Licences, advisories, sources and doubles of what is built in; needs `cargo install cargo-deny`.
deny:
	$(CARGO) deny check
