!> hypre's structured multigrid (PFMG) for a symmetric seven-point matrix on boxes.
!>
!> The only file that knows hypre. What takes a communicator goes through hypre's Fortran 77 names, which accept a
!> Fortran communicator on every MPI; the rest through the C names. hypre's integers are taken to be 32 bits wide.
!> Source: hypre 2.26 reference manual, chapters 2 and 4.
module hypre_struct
  use, intrinsic :: iso_c_binding, only: c_int, c_double, c_ptr, c_null_ptr, c_associated
  use kinds, only: wp
  implicit none
  private
  public :: hypre_struct_t

  integer(c_int), parameter :: entries = 4                       !< the cell itself and its three upper neighbours
  integer(c_int), parameter :: entry(entries) = [0, 1, 2, 3]
  integer(c_int), parameter :: weighted_jacobi = 1               !< PFMG's relaxation; red-black costs PCG up to 90 % more
  real(c_double), parameter :: weight = 0.8_c_double             !< of it; PCG takes a tenth more iterations with hypre's own 2/3
  integer(c_int), parameter :: yes = 1, one_cycle = 1

  !> One matrix over the boxes of all ranks, its right-hand side and solution, and the solver set up for it.
  type :: hypre_struct_t
    private
    integer(c_int) :: comm, lo(3), hi(3)
    type(c_ptr) :: grid = c_null_ptr
    type(c_ptr) :: stencil = c_null_ptr
    type(c_ptr) :: matrix = c_null_ptr
    type(c_ptr) :: rhs = c_null_ptr
    type(c_ptr) :: solution = c_null_ptr
    type(c_ptr) :: multigrid = c_null_ptr
  contains
    procedure :: create
    procedure :: set_matrix
    procedure :: cycle
    procedure :: destroy
  end type hypre_struct_t

  abstract interface
    !> Through a Fortran 77 name: a solver on a communicator.
    subroutine solver_on_ranks(comm, solver, error) bind(c)
      import :: c_int, c_ptr
      implicit none
      integer(c_int), intent(in) :: comm
      type(c_ptr), intent(out) :: solver
      integer(c_int), intent(out) :: error
    end subroutine solver_on_ranks

    !> One handle: assemble, initialise, destroy.
    function one_handle(handle) result(error) bind(c)
      import :: c_int, c_ptr
      implicit none
      type(c_ptr), value :: handle
      integer(c_int) :: error
    end function one_handle

    function handle_and_integer(handle, value) result(error) bind(c)
      import :: c_int, c_ptr
      implicit none
      type(c_ptr), value :: handle
      integer(c_int), value :: value
      integer(c_int) :: error
    end function handle_and_integer

    function handle_and_integers(handle, values) result(error) bind(c)
      import :: c_int, c_ptr
      implicit none
      type(c_ptr), value :: handle
      integer(c_int), intent(in) :: values(*)
      integer(c_int) :: error
    end function handle_and_integers

    function handle_and_real(handle, value) result(error) bind(c)
      import :: c_int, c_ptr, c_double
      implicit none
      type(c_ptr), value :: handle
      real(c_double), value :: value
      integer(c_int) :: error
    end function handle_and_real

    !> Set-up and solution alike.
    function solver_step(solver, matrix, rhs, solution) result(error) bind(c)
      import :: c_int, c_ptr
      implicit none
      type(c_ptr), value :: solver, matrix, rhs, solution
      integer(c_int) :: error
    end function solver_step
  end interface

  procedure(solver_on_ranks), bind(c, name='hypre_structpfmgcreate_') :: multigrid_create
  procedure(one_handle), bind(c, name='HYPRE_StructGridAssemble') :: grid_assemble
  procedure(one_handle), bind(c, name='HYPRE_StructGridDestroy') :: grid_destroy
  procedure(one_handle), bind(c, name='HYPRE_StructStencilDestroy') :: stencil_destroy
  procedure(one_handle), bind(c, name='HYPRE_StructMatrixInitialize') :: matrix_initialise
  procedure(one_handle), bind(c, name='HYPRE_StructMatrixAssemble') :: matrix_assemble
  procedure(one_handle), bind(c, name='HYPRE_StructMatrixDestroy') :: matrix_destroy
  procedure(one_handle), bind(c, name='HYPRE_StructVectorInitialize') :: vector_initialise
  procedure(one_handle), bind(c, name='HYPRE_StructVectorAssemble') :: vector_assemble
  procedure(one_handle), bind(c, name='HYPRE_StructVectorDestroy') :: vector_destroy
  procedure(one_handle), bind(c, name='HYPRE_StructPFMGDestroy') :: multigrid_destroy
  procedure(one_handle), bind(c, name='HYPRE_StructPFMGSetZeroGuess') :: multigrid_zero_guess
  procedure(handle_and_integer), bind(c, name='HYPRE_StructMatrixSetSymmetric') :: matrix_symmetric
  procedure(handle_and_integer), bind(c, name='HYPRE_StructPFMGSetMaxIter') :: multigrid_iterations
  procedure(handle_and_integer), bind(c, name='HYPRE_StructPFMGSetRelaxType') :: multigrid_relaxation
  procedure(handle_and_integers), bind(c, name='HYPRE_StructGridSetPeriodic') :: grid_periodic
  procedure(handle_and_real), bind(c, name='HYPRE_StructPFMGSetTol') :: multigrid_tolerance
  procedure(handle_and_real), bind(c, name='HYPRE_StructPFMGSetJacobiWeight') :: multigrid_weight
  procedure(solver_step), bind(c, name='HYPRE_StructPFMGSetup') :: multigrid_setup
  procedure(solver_step), bind(c, name='HYPRE_StructPFMGSolve') :: multigrid_solve

  interface
    subroutine grid_create(comm, dimensions, grid, error) bind(c, name='hypre_structgridcreate_')
      import :: c_int, c_ptr
      implicit none
      integer(c_int), intent(in) :: comm, dimensions
      type(c_ptr), intent(out) :: grid
      integer(c_int), intent(out) :: error
    end subroutine grid_create

    subroutine matrix_create(comm, grid, stencil, matrix, error) bind(c, name='hypre_structmatrixcreate_')
      import :: c_int, c_ptr
      implicit none
      integer(c_int), intent(in) :: comm
      type(c_ptr), intent(in) :: grid, stencil
      type(c_ptr), intent(out) :: matrix
      integer(c_int), intent(out) :: error
    end subroutine matrix_create

    subroutine vector_create(comm, grid, vector, error) bind(c, name='hypre_structvectorcreate_')
      import :: c_int, c_ptr
      implicit none
      integer(c_int), intent(in) :: comm
      type(c_ptr), intent(in) :: grid
      type(c_ptr), intent(out) :: vector
      integer(c_int), intent(out) :: error
    end subroutine vector_create

    function grid_extents(grid, lo, hi) result(error) bind(c, name='HYPRE_StructGridSetExtents')
      import :: c_int, c_ptr
      implicit none
      type(c_ptr), value :: grid
      integer(c_int), intent(in) :: lo(*), hi(*)
      integer(c_int) :: error
    end function grid_extents

    function stencil_create(dimensions, size, stencil) result(error) bind(c, name='HYPRE_StructStencilCreate')
      import :: c_int, c_ptr
      implicit none
      integer(c_int), value :: dimensions, size
      type(c_ptr), intent(out) :: stencil
      integer(c_int) :: error
    end function stencil_create

    function stencil_element(stencil, entry, offset) result(error) bind(c, name='HYPRE_StructStencilSetElement')
      import :: c_int, c_ptr
      implicit none
      type(c_ptr), value :: stencil
      integer(c_int), value :: entry
      integer(c_int), intent(in) :: offset(*)
      integer(c_int) :: error
    end function stencil_element

    function matrix_values(matrix, lo, hi, count, entry, values) result(error) &
      bind(c, name='HYPRE_StructMatrixSetBoxValues')
      import :: c_int, c_ptr, c_double
      implicit none
      type(c_ptr), value :: matrix
      integer(c_int), intent(in) :: lo(*), hi(*)
      integer(c_int), value :: count
      integer(c_int), intent(in) :: entry(*)
      real(c_double), intent(in) :: values(*)
      integer(c_int) :: error
    end function matrix_values

    function vector_values(vector, lo, hi, values) result(error) bind(c, name='HYPRE_StructVectorSetBoxValues')
      import :: c_int, c_ptr, c_double
      implicit none
      type(c_ptr), value :: vector
      integer(c_int), intent(in) :: lo(*), hi(*)
      real(c_double), intent(in) :: values(*)
      integer(c_int) :: error
    end function vector_values

    function vector_read(vector, lo, hi, values) result(error) bind(c, name='HYPRE_StructVectorGetBoxValues')
      import :: c_int, c_ptr, c_double
      implicit none
      type(c_ptr), value :: vector
      integer(c_int), intent(in) :: lo(*), hi(*)
      real(c_double), intent(out) :: values(*)
      integer(c_int) :: error
    end function vector_read
  end interface

contains

  !> The grid and empty vectors for a box of cells lo..hi on this rank.
  subroutine create(self, comm, lo, hi, periods)
    class(hypre_struct_t), intent(inout) :: self
    integer, intent(in) :: comm          !< Fortran communicator handle
    integer, intent(in) :: lo(3), hi(3)  !< my cells, counted in the whole grid
    integer, intent(in) :: periods(3)    !< cells of a periodic direction, 0 where it is not

    integer(c_int) :: error, offset(3)
    integer :: a

    self%comm = comm
    self%lo = lo
    self%hi = hi
    call grid_create(self%comm, 3_c_int, self%grid, error)
    error = grid_extents(self%grid, self%lo, self%hi)
    error = grid_periodic(self%grid, int(periods, c_int))
    error = grid_assemble(self%grid)
    error = stencil_create(3_c_int, entries, self%stencil)
    error = stencil_element(self%stencil, entry(1), [0_c_int, 0_c_int, 0_c_int])
    do a = 1, 3
      offset = 0
      offset(a) = 1
      error = stencil_element(self%stencil, entry(a + 1), offset)
    end do
    call matrix_create(self%comm, self%grid, self%stencil, self%matrix, error)
    error = matrix_symmetric(self%matrix, yes)
    error = matrix_initialise(self%matrix)
    call create_vector(self%comm, self%grid, self%rhs)
    call create_vector(self%comm, self%grid, self%solution)
  end subroutine create

  subroutine create_vector(comm, grid, vector)
    integer(c_int), intent(in) :: comm
    type(c_ptr), intent(in) :: grid
    type(c_ptr), intent(out) :: vector

    integer(c_int) :: error

    call vector_create(comm, grid, vector, error)
    error = vector_initialise(vector)
    error = vector_assemble(vector)
  end subroutine create_vector

  !> New matrix values, and multigrid set up for them.
  subroutine set_matrix(self, diagonal, upper)
    class(hypre_struct_t), intent(inout) :: self
    real(wp), intent(in), contiguous :: diagonal(:,:,:)  !< (cells)
    real(wp), intent(in), contiguous :: upper(:,:,:,:)   !< (cells, a) coefficient of the upper neighbour across a

    integer(c_int) :: error
    integer :: a

    error = matrix_values(self%matrix, self%lo, self%hi, 1_c_int, entry(1:1), diagonal)
    do a = 1, 3
      error = matrix_values(self%matrix, self%lo, self%hi, 1_c_int, entry(a + 1:a + 1), upper(:, :, :, a))
    end do
    error = matrix_assemble(self%matrix)
    call drop_solver(self)
    call multigrid_create(self%comm, self%multigrid, error)
    error = multigrid_tolerance(self%multigrid, 0.0_c_double)
    error = multigrid_iterations(self%multigrid, one_cycle)
    error = multigrid_zero_guess(self%multigrid)
    error = multigrid_relaxation(self%multigrid, weighted_jacobi)
    error = multigrid_weight(self%multigrid, weight)
    error = multigrid_setup(self%multigrid, self%matrix, self%rhs, self%solution)
  end subroutine set_matrix

  !> One cycle of multigrid from a zero guess.
  subroutine cycle(self, rhs, solution)
    class(hypre_struct_t), intent(inout) :: self
    real(wp), intent(in), contiguous :: rhs(:,:,:)
    real(wp), intent(out), contiguous :: solution(:,:,:)

    integer(c_int) :: error

    error = vector_values(self%rhs, self%lo, self%hi, rhs)
    error = multigrid_solve(self%multigrid, self%matrix, self%rhs, self%solution)
    error = vector_read(self%solution, self%lo, self%hi, solution)
  end subroutine cycle

  subroutine drop_solver(self)
    class(hypre_struct_t), intent(inout) :: self

    integer(c_int) :: error

    if (.not. c_associated(self%multigrid)) return
    error = multigrid_destroy(self%multigrid)
    self%multigrid = c_null_ptr
  end subroutine drop_solver

  !> Give everything back; before MPI ends.
  subroutine destroy(self)
    class(hypre_struct_t), intent(inout) :: self

    integer(c_int) :: error

    if (.not. c_associated(self%grid)) return
    call drop_solver(self)
    call destroy_vector(self%solution)
    call destroy_vector(self%rhs)
    error = matrix_destroy(self%matrix)
    error = stencil_destroy(self%stencil)
    error = grid_destroy(self%grid)
    self%grid = c_null_ptr
  end subroutine destroy

  !> On its own: in the second call within one procedure gfortran 12 hands over the address of the handle, not its value.
  subroutine destroy_vector(vector)
    type(c_ptr), intent(in) :: vector

    integer(c_int) :: error

    error = vector_destroy(vector)
  end subroutine destroy_vector

end module hypre_struct
