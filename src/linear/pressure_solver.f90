!> The pressure-correction equation over the boxes of all ranks,
!>
!>   sum over the faces of a cell of c_f (p_cell - p_beyond) = b,     c_f >= 0
!>
!> with p_beyond = 0 behind a boundary face of given pressure and c_f = 0 at a face of given velocity.
!> Where no pressure is given its level is free: it is held near 0 in a cell, see free_levels. Cells that store what their
!> pressure asks for add a capacity s_cell p_cell on the left; with them no level is free.
!>
!> Solved by conjugate gradients (Hestenes and Stiefel, J. Res. Natl. Bur. Stand. 49 (1952) 409), preconditioned by a cycle of
!> hypre's multigrid. hypre's own conjugate gradients go through one more cycle after the last iteration: a tenth of the gas.
!> Setting multigrid up costs as much as several cycles, and matrices change little from step to step. So it is kept while the
!> iterations it has cost, beside those right after it was set up, are fewer than that. Its matrix is part of the state of a run.
!> PFMG is at a loss where an odd number of cells goes round: it is told that they end there, which costs three times the iterations
!> of an even number, but not the more the more cells there are.
module pressure_solver
  use boxes, only: boxes_t
  use communicator, only: communicator_t
  use free_levels, only: free_levels_t
  use halo, only: halo_t, new_halo
  use hypre_struct, only: hypre_struct_t
  use kinds, only: wp
  use mesh, only: unit_step
  implicit none
  private
  public :: pressure_solver_t, pace_size

  integer, parameter :: most_iterations = 200
  real(wp), parameter :: price = 6.0_wp       !< of setting multigrid up, in iterations
  integer, parameter :: pace_size = 3

  type :: pressure_solver_t
    private
    type(hypre_struct_t) :: multigrid
    type(communicator_t) :: comm
    type(halo_t) :: halo
    integer :: n(3)                             !< cells of my box
    logical :: coupled(3)                       !< directions in which a cell has another neighbour than itself
    logical :: at_high(3)                       !< whether the faces above my last cells are the domain's surface
    logical :: at_seam(3)                       !< whether they are where multigrid sees an end, but the domain goes round
    type(free_levels_t) :: levels               !< where no pressure is given
    logical, allocatable :: closed(:,:,:)       !< (cells) those without a pressure; exists if there may be any
    logical, allocatable :: held(:,:,:)         !< (0:n1+1,0:n2+1,0:n3+1) those with p = 0; exists if there may be any
    real(wp), allocatable :: diagonal(:,:,:)    !< (cells) sum of c_f, and s_cell
    real(wp), allocatable :: link(:,:,:,:)      !< (0:n1,0:n2,0:n3, a) c_f of a cell's upper face across a, if both are unknown
    logical :: moved = .true.                   !< whether the matrix is another than that of multigrid
    real(wp) :: pace = 0.0_wp                   !< iterations per decade of the residual while it was the same; 0 if not known
    real(wp) :: iterations = 0.0_wp, decades = 0.0_wp  !< since then, or, while there is no pace, up to now
    real(wp), allocatable :: basis(:,:,:,:)     !< (cells, 4) matrix of multigrid: diagonal, upper neighbours; exists once set up
    real(wp) :: pace_before(pace_size) = 0.0_wp    !< pace, iterations, decades when `remember` was called
    real(wp), allocatable :: basis_before(:,:,:,:)  !< basis then, if replaced
    logical :: replaced = .false.               !< whether multigrid has been set up since then
    real(wp), allocatable :: residual(:,:,:)    !< (cells) b less matrix times solution
    real(wp), allocatable :: smoothed(:,:,:)    !< (cells) it after a cycle of multigrid
    real(wp), allocatable :: direction(:,:,:)   !< (-1:n1+2,-1:n2+2,-1:n3+2) in which the solution is improved
    real(wp), allocatable :: image(:,:,:)       !< (cells) matrix times direction
  contains
    procedure :: create
    procedure :: hold
    procedure :: set_matrix
    procedure :: solve
    procedure :: remember
    procedure :: recall
    procedure :: export_state
    procedure :: import_state
    procedure :: destroy
  end type pressure_solver_t

contains

  subroutine create(self, boxes, levels, closed)
    class(pressure_solver_t), intent(inout) :: self
    type(boxes_t), intent(in) :: boxes
    type(free_levels_t), intent(in) :: levels        !< that no boundary face gives
    logical, intent(in), optional :: closed(:,:,:)   !< (cells) cells that no face connects

    logical :: goes_round(3)

    self%comm = boxes%comm
    self%halo = new_halo(boxes)
    self%n = boxes%n
    self%coupled = boxes%cells > 1 .or. .not. boxes%periodic
    self%at_high = boxes%at_high
    goes_round = boxes%periodic .and. modulo(boxes%cells, 2) == 0
    self%at_seam = self%coupled .and. boxes%periodic .and. .not. goes_round .and. boxes%hi == boxes%cells
    self%levels = levels
    if (present(closed)) self%closed = closed
    associate (n => boxes%n)
      allocate (self%diagonal(n(1), n(2), n(3)), source=0.0_wp)
      allocate (self%residual, self%smoothed, self%image, source=self%diagonal)
      allocate (self%link(0:n(1), 0:n(2), 0:n(3), 3), self%direction(-1:n(1) + 2, -1:n(2) + 2, -1:n(3) + 2), source=0.0_wp)
    end associate
    call self%multigrid%create(boxes%comm%handle%mpi_val, boxes%lo, boxes%hi, merge(boxes%cells, 0, goes_round))
  end subroutine create

  !> Keep p = 0 in some cells from now on.
  subroutine hold(self, cells)
    class(pressure_solver_t), intent(inout) :: self
    logical, intent(in) :: cells(0:, 0:, 0:)  !< (0:n1+1,0:n2+1,0:n3+1)

    allocate (self%held(0:ubound(cells, 1), 0:ubound(cells, 2), 0:ubound(cells, 3)), source=cells)
  end subroutine hold

  !> Take new coefficients.
  subroutine set_matrix(self, conductance, capacity)
    class(pressure_solver_t), intent(inout) :: self
    real(wp), intent(in), contiguous :: conductance(-1:, -1:, -1:, :)  !< (cell, a): c_f of its upper face across a
    real(wp), intent(in), optional :: capacity(:,:,:)                  !< (cells) s_cell, none if not given

    real(wp) :: usual
    integer :: a, p

    if (.not. self%pace > 0.0_wp .and. self%decades > 0.0_wp) then
      self%pace = self%iterations/self%decades
      self%iterations = 0.0_wp
      self%decades = 0.0_wp
    end if
    self%moved = .true.
    self%diagonal = 0.0_wp
    if (present(capacity)) self%diagonal = capacity
    do a = 1, 3
      if (self%coupled(a)) call set_links(self, a, conductance(:, :, :, a))
    end do
    ! doubling one diagonal draws the level there to 0 and leaves the other equations as they are
    do p = 1, self%levels%n
      associate (c => self%levels%cell(:, p))
        if (self%levels%is_mine(p, self%n)) self%diagonal(c(1), c(2), c(3)) = 2*self%diagonal(c(1), c(2), c(3))
      end associate
    end do
    if (allocated(self%closed)) then
      usual = self%comm%max(maxval(self%diagonal))
      where (self%closed) self%diagonal = usual
    end if
  end subroutine set_matrix

  !> Set multigrid up for the matrix.
  subroutine set_up(self)
    class(pressure_solver_t), intent(inout) :: self

    integer :: a

    if (.not. self%replaced) call move_alloc(self%basis, self%basis_before)
    self%replaced = .true.
    if (.not. allocated(self%basis)) allocate (self%basis(self%n(1), self%n(2), self%n(3), 4))
    self%basis(:, :, :, 1) = self%diagonal
    self%basis(:, :, :, 2:) = -self%link(1:, 1:, 1:, :)
    do a = 1, 3
      if (self%at_seam(a)) call clear_last(a, self%basis(:, :, :, 1 + a))
    end do
    call self%multigrid%set_matrix(self%basis(:, :, :, 1), self%basis(:, :, :, 2:))
    self%moved = .false.
    self%pace = 0.0_wp
    self%iterations = 0.0_wp
    self%decades = 0.0_wp
  end subroutine set_up

  !> Whether multigrid has cost more than setting it up anew would. While it has no pace, for it has not come on even with its own
  !> matrix, all its iterations count.
  pure function is_worn(self)
    class(pressure_solver_t), intent(in) :: self
    logical :: is_worn

    is_worn = .not. allocated(self%basis) .or. self%iterations - self%pace*self%decades > price
  end function is_worn

  !> What cells have to do with their neighbours across a.
  pure subroutine set_links(self, a, conductance)
    class(pressure_solver_t), intent(inout) :: self
    integer, intent(in) :: a
    real(wp), intent(in) :: conductance(-1:self%n(1) + 2, -1:self%n(2) + 2, -1:self%n(3) + 2)

    integer :: i, j, k, e(3)

    e = unit_step(a)
    associate (n => self%n, held => self%held)
      do k = 1, n(3)
        do j = 1, n(2)
          do i = 1, n(1)
            self%diagonal(i, j, k) = self%diagonal(i, j, k) + conductance(i, j, k) + conductance(i - e(1), j - e(2), k - e(3))
          end do
        end do
      end do
      self%link(:, :, :, a) = conductance(0:n(1), 0:n(2), 0:n(3))
      if (allocated(self%held)) then
        where (held(0:n(1), 0:n(2), 0:n(3)) .or. held(e(1):n(1) + e(1), e(2):n(2) + e(2), e(3):n(3) + e(3)))
          self%link(:, :, :, a) = 0.0_wp
        end where
      end if
    end associate
    if (self%at_high(a)) call clear_last(a, self%link(:, :, :, a))
  end subroutine set_links

  !> 0 in the last layer across a.
  pure subroutine clear_last(a, f)
    integer, intent(in) :: a
    real(wp), intent(inout), contiguous :: f(:,:,:)

    if (a == 1) f(size(f, 1), :, :) = 0.0_wp
    if (a == 2) f(:, size(f, 2), :) = 0.0_wp
    if (a == 3) f(:, :, size(f, 3)) = 0.0_wp
  end subroutine clear_last

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
    p(1:self%n(1), 1:self%n(2), 1:self%n(3)) = 0.0_wp
    if (self%moved .and. is_worn(self)) call set_up(self)
    call iterate(self, b, reduction, p, iterations)
  end subroutine solve

  !> Conjugate gradients. What stops short is seen by the caller, who measures what is left.
  subroutine iterate(self, b, reduction, p, iterations)
    class(pressure_solver_t), intent(inout) :: self
    real(wp), intent(in), contiguous :: b(:,:,:)
    real(wp), intent(in) :: reduction
    real(wp), intent(inout), contiguous :: p(-1:, -1:, -1:)  !< 0 in the cells
    integer, intent(out) :: iterations

    real(wp) :: left, goal, start    !< square of the 2-norm of the residual, what it shall be, and was
    real(wp) :: slope, slope_before  !< residual . smoothed
    real(wp) :: bend                 !< direction . matrix times direction

    self%residual = b
    left = self%comm%sum(product_of(self%n, b, b))
    start = left
    goal = reduction**2*left
    slope_before = 1.0_wp
    self%direction = 0.0_wp
    iterations = 0
    do while (left > goal .and. iterations < most_iterations)
      call self%multigrid%cycle(self%residual, self%smoothed)
      slope = self%comm%sum(product_of(self%n, self%residual, self%smoothed))
      call turn(self%n, self%smoothed, slope/slope_before, self%direction)
      call self%halo%exchange(self%direction)
      call apply(self%n, self%diagonal, self%link, self%direction, self%image, bend)
      bend = self%comm%sum(bend)
      if (.not. bend > 0.0_wp) exit
      call go(self%n, slope/bend, self%direction, self%image, p, self%residual, left)
      left = self%comm%sum(left)
      slope_before = slope
      iterations = iterations + 1
    end do
    self%iterations = self%iterations + iterations
    if (iterations > 0) self%decades = self%decades + 0.5_wp*log10(start/max(left, tiny(left)))
  end subroutine iterate

  !> A step begins that may be taken back.
  pure subroutine remember(self)
    class(pressure_solver_t), intent(inout) :: self

    self%replaced = .false.
    self%pace_before = [self%pace, self%iterations, self%decades]
  end subroutine remember

  !> It is taken back.
  subroutine recall(self)
    class(pressure_solver_t), intent(inout) :: self

    if (self%replaced) then
      deallocate (self%basis)
      if (allocated(self%basis_before)) call take_over(self, self%basis_before)
      self%replaced = .false.
    end if
    call set_pace(self, self%pace_before)
  end subroutine recall

  !> The multigrid of this matrix.
  subroutine take_over(self, matrix)
    class(pressure_solver_t), intent(inout) :: self
    real(wp), intent(in) :: matrix(:,:,:,:)  !< (cells, 4)

    self%basis = matrix
    call self%multigrid%set_matrix(self%basis(:, :, :, 1), self%basis(:, :, :, 2:))
  end subroutine take_over

  pure subroutine set_pace(self, pace)
    class(pressure_solver_t), intent(inout) :: self
    real(wp), intent(in) :: pace(pace_size)

    self%pace = pace(1)
    self%iterations = pace(2)
    self%decades = pace(3)
  end subroutine set_pace

  !> The matrix of multigrid and how it has done; no matrix is all 0.
  subroutine export_state(self, matrix, pace)
    class(pressure_solver_t), intent(in) :: self
    real(wp), intent(out) :: matrix(:,:,:,:)  !< (cells, 4) diagonal and coefficients of the upper neighbours
    real(wp), intent(out) :: pace(pace_size)  !< pace, iterations, decades

    matrix = 0.0_wp
    if (allocated(self%basis)) matrix = self%basis
    pace = [self%pace, self%iterations, self%decades]
  end subroutine export_state

  !> Go on with the multigrid of another run.
  subroutine import_state(self, matrix, pace)
    class(pressure_solver_t), intent(inout) :: self
    real(wp), intent(in) :: matrix(:,:,:,:)  !< (cells, 4)
    real(wp), intent(in) :: pace(pace_size)

    if (.not. self%comm%any_of(any(matrix > 0.0_wp))) return
    call take_over(self, matrix)
    call set_pace(self, pace)
  end subroutine import_state

  !> x . y over my cells.
  pure function product_of(n, x, y) result(total)
    integer, intent(in) :: n(3)
    real(wp), intent(in), dimension(product(n)) :: x, y
    real(wp) :: total

    integer :: i

    total = 0.0_wp
    !$omp simd reduction(+:total)
    do i = 1, product(n)
      total = total + x(i)*y(i)
    end do
  end function product_of

  !> direction = smoothed + share*direction
  pure subroutine turn(n, smoothed, share, direction)
    integer, intent(in) :: n(3)
    real(wp), intent(in) :: smoothed(n(1), n(2), n(3)), share
    real(wp), intent(inout) :: direction(-1:n(1) + 2, -1:n(2) + 2, -1:n(3) + 2)

    integer :: i, j, k

    do k = 1, n(3)
      do j = 1, n(2)
        do i = 1, n(1)
          direction(i, j, k) = smoothed(i, j, k) + share*direction(i, j, k)
        end do
      end do
    end do
  end subroutine turn

  !> image = matrix times x, and image . x
  pure subroutine apply(n, diagonal, link, x, image, bend)
    integer, intent(in) :: n(3)
    real(wp), intent(in) :: diagonal(n(1), n(2), n(3)), link(0:n(1), 0:n(2), 0:n(3), 3)
    real(wp), intent(in) :: x(-1:n(1) + 2, -1:n(2) + 2, -1:n(3) + 2)
    real(wp), intent(out) :: image(n(1), n(2), n(3)), bend

    integer :: i, j, k

    bend = 0.0_wp
    do k = 1, n(3)
      do j = 1, n(2)
        !$omp simd reduction(+:bend)
        do i = 1, n(1)
          image(i, j, k) = diagonal(i, j, k)*x(i, j, k) &
            - link(i, j, k, 1)*x(i + 1, j, k) - link(i - 1, j, k, 1)*x(i - 1, j, k) &
            - link(i, j, k, 2)*x(i, j + 1, k) - link(i, j - 1, k, 2)*x(i, j - 1, k) &
            - link(i, j, k, 3)*x(i, j, k + 1) - link(i, j, k - 1, 3)*x(i, j, k - 1)
          bend = bend + image(i, j, k)*x(i, j, k)
        end do
      end do
    end do
  end subroutine apply

  !> p + length*direction, the residual less what that does to it, and the square of its 2-norm.
  pure subroutine go(n, length, direction, image, p, residual, left)
    integer, intent(in) :: n(3)
    real(wp), intent(in) :: length, image(n(1), n(2), n(3))
    real(wp), intent(in), dimension(-1:n(1) + 2, -1:n(2) + 2, -1:n(3) + 2) :: direction
    real(wp), intent(inout) :: p(-1:n(1) + 2, -1:n(2) + 2, -1:n(3) + 2)
    real(wp), intent(inout) :: residual(n(1), n(2), n(3))
    real(wp), intent(out) :: left

    integer :: i, j, k

    left = 0.0_wp
    do k = 1, n(3)
      do j = 1, n(2)
        !$omp simd reduction(+:left)
        do i = 1, n(1)
          p(i, j, k) = p(i, j, k) + length*direction(i, j, k)
          residual(i, j, k) = residual(i, j, k) - length*image(i, j, k)
          left = left + residual(i, j, k)**2
        end do
      end do
    end do
  end subroutine go

  subroutine destroy(self)
    class(pressure_solver_t), intent(inout) :: self

    call self%multigrid%destroy()
  end subroutine destroy

end module pressure_solver
