# make            build build/geldart
# make run        install what is missing, build, run the Geldart B bed, draw it
# make test       all tests
# make help       the other targets, and the variables to set on a cluster
VERSION = 0.1.0

# What differs between machines. On a cluster: on the command line, or in a file config.mk here.
MODE  ?= release
ARCH  ?= native
RANKS ?= 2
JOBS  ?= $(shell nproc)
-include config.mk

FC          = mpifort
HDF5_CFLAGS = $(shell pkg-config --cflags-only-I hdf5-openmpi 2>/dev/null)
HDF5_LIBS   = $(shell pkg-config --libs-only-L hdf5-openmpi 2>/dev/null) -lhdf5_fortran -lhdf5
METIS_LIBS  = -lmetis
HYPRE_LIBS  = -lHYPRE
LIBS        = $(HDF5_LIBS) $(METIS_LIBS) $(HYPRE_LIBS)
MPIRUN      = mpirun
PYTHON      = python3
VENV        = .venv

# Objects carry machine code beside what link-time optimization reads (fat), so that the many test
# programs link in a moment and only the programs whose speed matters are optimized as a whole. Unit tests
# themselves are not optimized at all (CHECK_FLAGS): to do so took as long as all the rest. Vectors are
# as wide as the processor has them (WIDE): with 512 bits the contact loop is 5 % faster than with 256.
STANDARD      = -std=f2008 -g -fopenmp-simd -Wall -Wextra -Wpedantic
WIDE         := $(if $(filter x86_64,$(shell uname -m)),-mprefer-vector-width=512)
release_FLAGS = -O3 -march=$(ARCH) $(WIDE) -flto=auto -ffat-lto-objects
debug_FLAGS   = -O0 -fcheck=all -ffpe-trap=invalid,zero,overflow -finit-real=snan -Werror
FFLAGS        = $(STANDARD) $($(MODE)_FLAGS)
CHECK_FLAGS   = -O0 -fno-lto

B       := build/$(MODE)
SRC     := $(shell find src model -name '*.f90' | LC_ALL=C sort)
CHECKS  := $(shell find tests -name '*.f90' | LC_ALL=C sort)
TESTS   := $(foreach f,$(CHECKS),$(if $(filter test_% verify_%,$(notdir $f)),$(f:%.f90=$(B)/%)))
VERIFY  := $(filter $(B)/tests/verification/%,$(TESTS))
BENCHES := $(patsubst %.f90,$(B)/%,$(filter tests/bench/bench_%.f90,$(CHECKS)))
TEXTS    = $(sort $(wildcard src/build/* doc/*.md cases/*.py cases/*/*.md cases/*/*.py cases/*/*.nml tests/*.py tests/*/*.py tests/*/*.nml))
LAYERS   = src/base src/parallel src/grid src/linear src/io model/gas,model/des,model/psd model/coupling model/run src
BED      = cases/geldart_b_bed
LAUNCH   = MPIRUN='$(MPIRUN)' sh src/build/launch.sh
BAR      = $(shell [ -t 2 ] && echo bar || echo lines)

ifeq (0,$(MAKELEVEL)$(filter -j%,$(MAKEFLAGS)))
MAKEFLAGS += -j$(JOBS)
endif

build: $(B)/src/geldart
	@ln -sfn $(MODE)/src/geldart build/geldart

build/geldart: build ;

unit: $(TESTS)

# --- compiling ---------------------------------------------------------------------------------

$(B)/tests/%: LINK = -fno-lto
$(B)/tests/bench/%: LINK =
$(B)/tests/unit/%.o: private PLAIN = $(CHECK_FLAGS)

$(B)/%: $(B)/%.o
	$(FC) $(FFLAGS) $(LINK) -o $@ $(filter %.o,$^) $(LIBS)

$(B)/%.o: %.f90 $(B)/flags
	@mkdir -p $(@D)
	$(FC) $(FFLAGS) $(PLAIN) $(HDF5_CFLAGS) -J$(B) -c -o $@ $<

$(B)/version.o: $(B)/version.f90
	$(FC) $(FFLAGS) -J$(B) -c -o $@ $<

# Both are rewritten only when their content changes, so nothing is compiled in vain.
$(B)/version.f90: always
	@sh src/build/version.sh $@ $(VERSION) $(MODE)

$(B)/flags: always
	@mkdir -p $(B); printf '%s\n' '$(FC) $(FFLAGS) $(HDF5_CFLAGS)' '$(CHECK_FLAGS)' | cmp -s - $@ || \
	  printf '%s\n' '$(FC) $(FFLAGS) $(HDF5_CFLAGS)' '$(CHECK_FLAGS)' > $@

$(B)/deps.mk: $(SRC) $(CHECKS) src/build/deps.awk | $(B)/version.f90
	@awk -v B=$(B) -f src/build/deps.awk $(SRC) $(CHECKS) $(B)/version.f90 | LC_ALL=C sort > $@

# --- installing --------------------------------------------------------------------------------

deps:
	@FC='$(FC)' CFLAGS='$(HDF5_CFLAGS)' LIBS='$(LIBS)' PYTHON='$(PYTHON)' VENV='$(VENV)' sh src/build/deps.sh
	@$(MAKE) --no-print-directory -s venv

venv: $(VENV)/complete
$(VENV)/complete: tests/requirements.txt
	@echo "making $(VENV): Python packages for tests and pictures"
	@$(PYTHON) -m venv --clear $(VENV)
	@$(VENV)/bin/python -m pip install -q --disable-pip-version-check -r tests/requirements.txt
	@touch $@

# --- running -----------------------------------------------------------------------------------

run: deps
	@$(MAKE) --no-print-directory -s build
	@$(LAUNCH) $(RANKS) build/geldart $(BED)/case.nml --out $(BED)/results --force --set output%progress=$(BAR)
	@$(VENV)/bin/python $(BED)/validate.py

compare: deps
	@$(MAKE) --no-print-directory -s build
	@for run in dem ssw ssp; do \
	  $(LAUNCH) $(RANKS) build/geldart cases/compare/case.nml --set parcels%weighting=$$run \
	    --out cases/compare/results/$$run --force --set output%progress=$(BAR) || exit; done
	@$(VENV)/bin/python cases/compare/compare.py

validate: deps
	@$(MAKE) --no-print-directory -s build
	@status=0; for case in cases/*/validate.py; do echo "== $$case"; $(VENV)/bin/python $$case || status=1; done; exit $$status

# --- proving -----------------------------------------------------------------------------------

test: deps
	@$(MAKE) --no-print-directory -s lint
	@$(MAKE) --no-print-directory -s MODE=release build unit
	@$(MAKE) --no-print-directory -s MODE=debug build/debug/src/geldart unit
	@$(VENV)/bin/python -m pytest -n $(JOBS) tests

lint: venv
	@status=0; \
	awk -v ORDER="$(LAYERS)" -f src/build/layers.awk $(SRC) || status=1; \
	awk -f src/build/style.awk $(SRC) $(CHECKS) Makefile README.md $(TEXTS) || status=1; \
	$(VENV)/bin/fortitude check --quiet --output-format concise src model tests || status=1; \
	exit $$status

verify: venv
	@$(MAKE) --no-print-directory -s MODE=release verify_programs
	@$(VENV)/bin/python tests/verification/verify.py build/release

verify_programs: $(VERIFY)

bench: venv
	@$(MAKE) --no-print-directory -s build bench_programs
	@$(VENV)/bin/python tests/bench/run.py $(B) build/bench.json
	@$(VENV)/bin/python tests/bench/bed.py build/bench.json

bench-peers: venv
	@$(MAKE) --no-print-directory -s bench_programs
	@$(VENV)/bin/python tests/bench/peers.py $(B) build/bench_peers.json

bench-off: venv
	@$(MAKE) --no-print-directory -s bench_programs
	@$(VENV)/bin/python tests/bench/off.py $(B) build/bench_off.json $(MAKE)

bench_programs: $(BENCHES)

clean:
	rm -rf build

help:
	@sh src/build/help.sh

.PHONY: build build/geldart unit deps venv run compare validate test lint verify verify_programs bench bench-peers bench-off bench_programs clean help always
.SECONDARY:
ifneq (,$(filter-out deps venv run compare validate test lint verify bench bench-peers bench-off clean help,$(or $(MAKECMDGOALS),build)))
include $(B)/deps.mk
endif
