# See that what geldart is built from is here, and install what is not (Debian: as root or by sudo).
# Says nothing when everything is there.
# usage: FC=mpifort CFLAGS=... LIBS=... PYTHON=python3 VENV=.venv sh deps.sh
packages="gfortran make pkg-config openmpi-bin libopenmpi-dev libhdf5-openmpi-dev libmetis-dev libhypre-dev python3-venv"

# A program that needs every library, compiled and linked as geldart is.
links() {
  scratch=$(mktemp -d) || exit 4
  cat >"$scratch/probe.f90" <<'END'
program probe
  use mpi_f08, only: MPI_Init
  use hdf5, only: h5open_f, h5pset_fapl_mpio_f
  implicit none
  interface
    subroutine metis() bind(c, name='METIS_PartGraphKway')
    end subroutine metis
    subroutine hypre() bind(c, name='HYPRE_StructPFMGCreate')
    end subroutine hypre
  end interface
  integer :: error
  call MPI_Init()
  call h5open_f(error)
  call metis()
  call hypre()
end program probe
END
  (cd "$scratch" && $FC $CFLAGS -o probe probe.f90 $LIBS) >"$scratch/log" 2>&1
  status=$?
  [ $status = 0 ] || why=$(grep -m 3 -iE 'error|not found|cannot' "$scratch/log")
  rm -rf "$scratch"
  return $status
}

python_works() { [ -e "$VENV/complete" ] || "$PYTHON" -c 'import ensurepip, venv' 2>/dev/null; }

# The compiler flags of HDF5 are asked of pkg-config, which may have come only now.
refresh() {
  [ -n "$CFLAGS" ] || CFLAGS=$(pkg-config --cflags-only-I hdf5-openmpi 2>/dev/null)
  case "$LIBS" in *-L*) ;; *) LIBS="$(pkg-config --libs-only-L hdf5-openmpi 2>/dev/null) $LIBS" ;; esac
}

explain() {
  echo "geldart needs gfortran 12 or later, MPI, parallel HDF5 with Fortran, METIS, hypre, and Python 3.11 with venv."
  if command -v apt-get >/dev/null; then
    echo "Some of it is missing and I may not install it. As root:"
    echo "    apt-get install --no-install-recommends $packages"
  else
    echo "Some of it is missing. Install it, or say where it is (README.md, \"On a cluster\"):"
    echo "    make FC=... HDF5_CFLAGS=... HDF5_LIBS=... METIS_LIBS=... HYPRE_LIBS=... PYTHON=..."
  fi
  [ -z "$why" ] || printf 'The compiler said:\n%s\n' "$why"
  exit 4
}

links && python_works && exit 0

if ! command -v apt-get >/dev/null; then explain; fi
if [ "$(id -u)" = 0 ]; then as_root=env
elif command -v sudo >/dev/null && { [ -t 0 ] || sudo -n true 2>/dev/null; }; then as_root='sudo env'
else explain; fi

echo "installing what is missing of: $packages"
log=$(mktemp)
$as_root apt-get update >"$log" 2>&1 &&
  $as_root DEBIAN_FRONTEND=noninteractive apt-get install -y --no-install-recommends $packages >>"$log" 2>&1 ||
  { tail -n 5 "$log"; rm -f "$log"; explain; }
rm -f "$log"
refresh
links && python_works || explain
