!> The pressure-correction equation over the boxes of all ranks,
!>
!>   sum over the faces of a cell of c_f (p_cell - p_beyond) = b,     c_f >= 0
!>
!> with p_beyond = 0 behind a boundary face of given pressure and c_f = 0 at a face of given velocity.
!> Where no pressure is given its level is free: it is held near 0 in a cell, see free_levels. Cells that store what their
!> pressure asks for add a capacity s_cell p_cell on the left; with them no level is free.
module pressure_solver
  use boxes, only: boxes_t
  use communicator, only: communicator_t
  use free_levels, only: free_levels_t
  use hypre_struct, only: hypre_struct_t
  use kinds, only: wp
  implicit none
  private
  public :: pressure_solver_t

  integer, parameter :: most_iterations = 200

  type :: pressure_solver_t
    private
    type(hypre_struct_t) :: hypre
    type(communicator_t) :: comm
    integer :: n(3)                             !< cells of my box
    logical :: coupled(3)                       !< directions in which a cell has another neighbour than itself
    logical :: at_high(3)                       !< whether the faces above my last cells are the domain's surface
    type(free_levels_t) :: levels               !< where no pressure is given
    logical, allocatable :: closed(:,:,:)       !< (cells) those without a pressure; exists if there may be any
    logical, allocatable :: held(:,:,:)         !< (0:n1+1,0:n2+1,0:n3+1) those with p = 0; exists if there may be any
    real(wp), allocatable :: values(:,:,:,:)    !< (4, cells) diagonal; x, y, z upper neighbour
    real(wp), allocatable :: solution(:,:,:)
  contains
    procedure :: create
    procedure :: hold
    procedure :: set_matrix
    procedure :: solve
    procedure :: destroy
  end type pressure_solver_t

contains

  subroutine create(self, boxes, levels, closed)
    class(pressure_solver_t), intent(inout) :: self
    type(boxes_t), intent(in) :: boxes
    type(free_levels_t), intent(in) :: levels        !< that no boundary face gives
    logical, intent(in), optional :: closed(:,:,:)   !< (cells) cells that no face connects

    self%comm = boxes%comm
    self%n = boxes%n
    self%coupled = boxes%cells > 1 .or. .not. boxes%periodic
    self%at_high = boxes%at_high
    self%levels = levels
    if (present(closed)) self%closed = closed
    allocate (self%values(4, boxes%n(1), boxes%n(2), boxes%n(3)), source=0.0_wp)
    allocate (self%solution(boxes%n(1), boxes%n(2), boxes%n(3)), source=0.0_wp)
    call self%hypre%create(boxes%comm%handle%mpi_val, boxes%lo, boxes%hi, &
                           merge(boxes%cells, 0, boxes%periodic .and. boxes%cells > 1))
  end subroutine create

  !> Keep p = 0 in some cells from now on.
  subroutine hold(self, cells)
    class(pressure_solver_t), intent(inout) :: self
    logical, intent(in) :: cells(0:, 0:, 0:)  !< (0:n1+1,0:n2+1,0:n3+1)

    allocate (self%held(0:ubound(cells, 1), 0:ubound(cells, 2), 0:ubound(cells, 3)), source=cells)
  end subroutine hold

  !> Take new coefficients and set multigrid up for them.
  subroutine set_matrix(self, conductance, capacity)
    class(pressure_solver_t), intent(inout) :: self
    real(wp), intent(in), contiguous :: conductance(-1:, -1:, -1:, :)  !< (cell, a): c_f of its upper face across a
    real(wp), intent(in), optional :: capacity(:,:,:)                  !< (cells) s_cell, none if not given

    integer :: a, i, j, k, p, e(3), inner(3)
    real(wp) :: usual

    self%values = 0.0_wp
    if (present(capacity)) self%values(1, :, :, :) = capacity
    do a = 1, 3
      if (.not. self%coupled(a)) cycle
      e = unit_step(a)
      inner = self%n
      if (self%at_high(a)) inner(a) = inner(a) - 1
      do k = 1, self%n(3)
        do j = 1, self%n(2)
          do i = 1, self%n(1)
            self%values(1, i, j, k) = self%values(1, i, j, k) + conductance(i, j, k, a) &
              + conductance(i - e(1), j - e(2), k - e(3), a)
          end do
        end do
      end do
      do k = 1, inner(3)
        do j = 1, inner(2)
          do i = 1, inner(1)
            self%values(a + 1, i, j, k) = -conductance(i, j, k, a)
          end do
        end do
      end do
      if (allocated(self%held)) call let_go(self, a, e)
    end do
    ! doubling one diagonal draws the level there to 0 and leaves the other equations as they are
    do p = 1, self%levels%n
      associate (c => self%levels%cell(:, p))
        if (self%levels%is_mine(p, self%n)) self%values(1, c(1), c(2), c(3)) = 2*self%values(1, c(1), c(2), c(3))
      end associate
    end do
    if (allocated(self%closed)) then
      usual = self%comm%max(maxval(self%values(1, :, :, :)))
      where (self%closed) self%values(1, :, :, :) = usual
    end if
    call self%hypre%set_matrix(self%values)
  end subroutine set_matrix

  !> Held cells have no part in the equations of their neighbours across a.
  pure subroutine let_go(self, a, e)
    class(pressure_solver_t), intent(inout) :: self
    integer, intent(in) :: a, e(3)

    associate (n => self%n, held => self%held)
      where (held(1:n(1), 1:n(2), 1:n(3)) .or. held(1 + e(1):n(1) + e(1), 1 + e(2):n(2) + e(2), 1 + e(3):n(3) + e(3)))
        self%values(a + 1, :, :, :) = 0.0_wp
      end where
    end associate
  end subroutine let_go

  pure function unit_step(a) result(e)
    integer, intent(in) :: a
    integer :: e(3)

    e = 0
    e(a) = 1
  end function unit_step

  !> Solve from zero until the 2-norm of the residual has fallen by `reduction`.
  !> What a free level cannot satisfy, the mean of b, is taken out of b.
  subroutine solve(self, b, reduction, p, iterations)
    class(pressure_solver_t), intent(inout) :: self
    real(wp), intent(inout), contiguous :: b(:,:,:)
    real(wp), intent(in) :: reduction
    real(wp), intent(inout), contiguous :: p(-1:, -1:, -1:)  !< its cells are set, its halo is left
    integer, intent(out) :: iterations

    if (self%levels%n > 0) call self%levels%leave_out_means(self%comm, b)
    if (allocated(self%closed)) then
      where (self%closed) b = 0.0_wp
    end if
    if (allocated(self%held)) then
      where (self%held(1:self%n(1), 1:self%n(2), 1:self%n(3))) b = 0.0_wp
    end if
    call self%hypre%solve(b, reduction, most_iterations, self%solution, iterations)
    p(1:self%n(1), 1:self%n(2), 1:self%n(3)) = self%solution
  end subroutine solve

  subroutine destroy(self)
    class(pressure_solver_t), intent(inout) :: self

    call self%hypre%destroy()
  end subroutine destroy

end module pressure_solver
