# What `make help` prints.
cat <<'END'
make               build build/geldart
make run           install what is missing, build, run cases/geldart_b_bed on RANKS ranks, check and draw it
make test          lint, both builds, all tests
make compare       one small bed as DEM, as SSW and as SSP: what each costs and how far it is from DEM

make deps          install what is missing (apt, as root or by sudo; and the Python packages in .venv)
make unit          build the test programs of this MODE
make lint          style, layers, whitespace
make validate      every validate.py of cases/: physics against what it must be
make verify        verification: fill tests/verification/checks.csv, make tables and pictures of doc/verification.md
make bench         measure speeds into build/bench.json
make bench-peers   time the contact loop in turn with LAMMPS and LIGGGHTS, where these are installed
make bench-off     what the code of rolling resistance and attraction costs a bed that has neither
make clean         remove build/

Variables (on the command line, or in a file config.mk beside the Makefile):
  MODE=release|debug   which build                                  ARCH=native   -march of the compiler
  RANKS=2              MPI ranks of `make run` and `make compare`   JOBS=...      compilers and tests at a time
  FC=mpifort           MPI's Fortran compiler wrapper               MPIRUN=mpirun the launcher
  HDF5_CFLAGS HDF5_LIBS METIS_LIBS HYPRE_LIBS    where the libraries are (-I..., -L... -l...)
  PYTHON=python3 VENV=.venv                      for tests and pictures only

Building needs no network and no Python.
END
