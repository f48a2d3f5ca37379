# make            build build/geldart
# make run        install what is missing, build, run the Geldart B bed, draw it
# make test       all tests
# make help       the other targets and the variables to set on a cluster
MODE ?= release
ARCH ?= native
RANKS ?= 2

FC           = mpifort
HDF5_CFLAGS  = $(shell pkg-config --cflags-only-I hdf5-openmpi 2>/dev/null)
HDF5_LIBS    = $(shell pkg-config --libs-only-L hdf5-openmpi 2>/dev/null) -lhdf5_fortran -lhdf5
METIS_LIBS   = -lmetis
HYPRE_LIBS   = -lHYPRE
LIBS         = $(HDF5_LIBS) $(METIS_LIBS) $(HYPRE_LIBS)

STANDARD     = -std=f2008 -g -fopenmp-simd -Wall -Wextra -Wpedantic
release_FLAGS = -O3 -march=$(ARCH) -flto=auto
debug_FLAGS   = -O0 -fcheck=all -ffpe-trap=invalid,zero,overflow -finit-real=snan -Werror
FFLAGS       = $(STANDARD) $($(MODE)_FLAGS)

B       := build/$(MODE)
SRC     := $(shell find src model -name '*.f90' | LC_ALL=C sort)
UNIT    := $(shell find tests -name '*.f90' | LC_ALL=C sort)
TESTS   := $(patsubst %.f90,$(B)/%,$(shell find tests -name 'test_*.f90' | LC_ALL=C sort))

build: build/geldart

build/geldart: $(B)/src/geldart
	@ln -sf $(MODE)/src/geldart $@

$(B)/%: $(B)/%.o
	$(FC) $(FFLAGS) -o $@ $(filter %.o,$^) $(LIBS)

$(B)/%.o: %.f90
	@mkdir -p $(@D)
	$(FC) $(FFLAGS) $(HDF5_CFLAGS) -J$(B) -c -o $@ $<

$(B)/deps.mk: $(SRC) $(UNIT) src/build/deps.awk
	@mkdir -p $(B)
	@awk -v B=$(B) -f src/build/deps.awk $(SRC) $(UNIT) | LC_ALL=C sort > $@

unit: $(TESTS)

clean:
	rm -rf build

.PHONY: build unit clean
.SECONDARY:
ifneq ($(MAKECMDGOALS),clean)
include $(B)/deps.mk
endif
