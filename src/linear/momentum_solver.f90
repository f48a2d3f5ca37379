!> Linear systems of the momentum equation: seven-point matrices that are diagonally dominant but not symmetric.
!>
!>   centre u = sum over a of (low_a u_below_a + high_a u_above_a) + rhs,    low, high >= 0
!>
!> Jacobi sweeps, which do not see how the grid is cut into boxes; conjugate gradients (BiCGSTAB, van der Vorst,
!> SIAM J. Sci. Stat. Comput. 13 (1992) 631) with Jacobi's preconditioner where viscosity makes sweeps slow.
module momentum_solver
  use communicator, only: communicator_t
  use halo, only: halo_t
  use kinds, only: wp
  implicit none
  private
  public :: stencil_t, momentum_solver_t, find_residual

  integer, parameter :: most_sweeps = 6           !< Jacobi sweeps before gradients take over
  integer, parameter :: vectors = 5               !< that BiCGSTAB works with
  integer, parameter :: most_gradients = 400      !< iterations of BiCGSTAB
  real(wp), parameter :: slow = 0.6_wp            !< a sweep that leaves more of the residual than this is slow

  !> One component's matrix and right-hand side over faces lo..n of a box; allocated with these bounds.
  type :: stencil_t
    logical :: active = .false.                            !< whether the component has any unknown in the domain
    integer :: lo(3) = 1
    integer :: n(3) = 0
    real(wp), allocatable :: low(:,:,:,:), high(:,:,:,:)   !< (x, direction, y, z)
    real(wp), allocatable :: centre(:,:,:), rhs(:,:,:)
    real(wp), allocatable :: change(:,:,:)                 !< rhs - A u of the last sweep
  contains
    procedure :: allocate_faces
  end type stencil_t

  type :: momentum_solver_t
    integer :: sweeps = 0     !< sweeps and gradient iterations since last reset
    real(wp), allocatable, private :: work(:,:,:,:)  !< vectors of BiCGSTAB, made when first needed
  contains
    procedure :: residual
    procedure :: solve
    procedure, private :: solve_gradients
  end type momentum_solver_t

contains

  subroutine allocate_faces(self, lo, n)
    class(stencil_t), intent(inout) :: self
    integer, intent(in) :: lo(3), n(3)

    self%active = .true.
    self%lo = lo
    self%n = n
    allocate (self%low(lo(1):n(1), 3, lo(2):n(2), lo(3):n(3)), source=0.0_wp)
    allocate (self%high, source=self%low)
    allocate (self%centre(lo(1):n(1), lo(2):n(2), lo(3):n(3)), source=1.0_wp)
    allocate (self%rhs(lo(1):n(1), lo(2):n(2), lo(3):n(3)), source=0.0_wp)
    allocate (self%change, source=self%rhs)
  end subroutine allocate_faces

  !> Sum of |rhs - A u| and of |centre u| over all components and ranks; the residuals stay in the stencils.
  function residual(self, stencil, u, comm) result(sums)
    class(momentum_solver_t), intent(inout) :: self
    type(stencil_t), intent(inout) :: stencil(3)
    real(wp), intent(in), contiguous :: u(-1:, -1:, -1:, :)
    type(communicator_t), intent(in) :: comm
    real(wp) :: sums(2)

    real(wp) :: along(0:maxval(stencil%n(1)), 2)
    integer :: a

    along = 0.0_wp
    do a = 1, 3
      if (.not. stencil(a)%active) cycle
      associate (s => stencil(a))
        call find_residual(s%lo(2:3), s%n(2:3), s%lo, s%n, s%low, s%high, s%centre, s%rhs, u(:, :, :, a), s%change, along)
      end associate
    end do
    sums = comm%sum(sum(along, 1))
    self%sweeps = self%sweeps + 1
  end function residual

  !> Bring the residual that `residual` found last, of sum `first`, down by `reduction`: by sweeps while they are quick.
  subroutine solve(self, stencil, u, first, reduction, halo, comm)
    class(momentum_solver_t), intent(inout) :: self
    type(stencil_t), intent(inout) :: stencil(3)
    real(wp), intent(inout), contiguous :: u(-1:, -1:, -1:, :)
    real(wp), intent(in) :: first, reduction
    type(halo_t), intent(inout) :: halo
    type(communicator_t), intent(in) :: comm

    real(wp) :: sums(2), left, rate
    integer :: sweep

    if (first <= 0.0_wp) return
    left = first
    do sweep = 1, most_sweeps
      call apply_changes(stencil, u, halo)
      sums = self%residual(stencil, u, comm)
      rate = sums(1)/left
      left = sums(1)
      if (rate > slow .or. .not. rate >= 0.0_wp) exit
      if (left*rate > reduction*first .and. sweep < most_sweeps) cycle
      call apply_changes(stencil, u, halo)  ! the residual is known well enough without another look
      return
    end do
    call self%solve_gradients(stencil, u, reduction*first/left, halo, comm)
  end subroutine solve

  !> One Jacobi sweep from the residuals at hand.
  subroutine apply_changes(stencil, u, halo)
    type(stencil_t), intent(in) :: stencil(3)
    real(wp), intent(inout), contiguous :: u(-1:, -1:, -1:, :)
    type(halo_t), intent(inout) :: halo

    integer :: a

    do a = 1, 3
      if (.not. stencil(a)%active) cycle
      associate (s => stencil(a))
        call add_change(s%lo, s%n, s%centre, s%change, u(:, :, :, a))
      end associate
    end do
    call halo%exchange_many(u)
  end subroutine apply_changes

  !> u + change/centre
  pure subroutine add_change(lo, n, centre, change, u)
    integer, intent(in) :: lo(3), n(3)
    real(wp), intent(in), dimension(lo(1):n(1), lo(2):n(2), lo(3):n(3)) :: centre, change
    real(wp), intent(inout) :: u(-1:n(1) + 2, -1:n(2) + 2, -1:n(3) + 2)

    integer :: i, j, k

    do k = lo(3), n(3)
      do j = lo(2), n(2)
        do i = lo(1), n(1)
          u(i, j, k) = u(i, j, k) + change(i, j, k)/centre(i, j, k)
        end do
      end do
    end do
  end subroutine add_change

  !> change = rhs - A u in the rows from..to (y, z) of faces; its size and that of centre u are added to the sums, one for each
  !> place of a row: to add up a row would take as long as the rest.
  pure subroutine find_residual(from, to, lo, n, low, high, centre, rhs, u, change, sums)
    integer, intent(in) :: from(2), to(2)
    integer, intent(in) :: lo(3), n(3)  !< lo is 0 or 1
    real(wp), intent(in), dimension(lo(1):n(1), 3, lo(2):n(2), lo(3):n(3)) :: low, high
    real(wp), intent(in), dimension(lo(1):n(1), lo(2):n(2), lo(3):n(3)) :: centre, rhs
    real(wp), intent(in) :: u(-1:n(1) + 2, -1:n(2) + 2, -1:n(3) + 2)
    real(wp), intent(inout) :: change(lo(1):n(1), lo(2):n(2), lo(3):n(3))
    real(wp), intent(inout) :: sums(0:n(1), 2)

    integer :: i, j, k
    real(wp) :: own

    do k = from(2), to(2)
      do j = from(1), to(1)
        do i = lo(1), n(1)
          own = centre(i, j, k)*u(i, j, k)
          change(i, j, k) = rhs(i, j, k) - own &
            + low(i, 1, j, k)*u(i - 1, j, k) + high(i, 1, j, k)*u(i + 1, j, k) &
            + low(i, 2, j, k)*u(i, j - 1, k) + high(i, 2, j, k)*u(i, j + 1, k) &
            + low(i, 3, j, k)*u(i, j, k - 1) + high(i, 3, j, k)*u(i, j, k + 1)
          sums(i, 1) = sums(i, 1) + abs(change(i, j, k))
          sums(i, 2) = sums(i, 2) + abs(own)
        end do
      end do
    end do
  end subroutine find_residual

  !> Bring the residuals of all components down by `reduction` with BiCGSTAB.
  subroutine solve_gradients(self, stencil, u, reduction, halo, comm)
    class(momentum_solver_t), intent(inout) :: self
    type(stencil_t), intent(in) :: stencil(3)
    real(wp), intent(inout), contiguous :: u(-1:, -1:, -1:, :)
    real(wp), intent(in) :: reduction
    type(halo_t), intent(inout) :: halo
    type(communicator_t), intent(in) :: comm

    integer :: a

    if (.not. allocated(self%work)) then
      allocate (self%work(-1:ubound(u, 1), -1:ubound(u, 2), -1:ubound(u, 3), vectors))
    end if
    do a = 1, 3
      if (.not. stencil(a)%active) cycle
      self%work = 0.0_wp
      call gradients(stencil(a), u(:, :, :, a), reduction, self%work, halo, comm, self%sweeps)
    end do
    call halo%exchange_many(u)
  end subroutine solve_gradients

  !> BiCGSTAB for one component, its rows divided by the diagonal.
  subroutine gradients(s, u, reduction, work, halo, comm, count)
    type(stencil_t), intent(in) :: s
    real(wp), intent(inout), contiguous :: u(-1:, -1:, -1:)
    real(wp), intent(in) :: reduction
    real(wp), intent(inout), contiguous :: work(-1:, -1:, -1:, :)
    type(halo_t), intent(inout) :: halo
    type(communicator_t), intent(in) :: comm
    integer, intent(inout) :: count

    real(wp) :: rho, rho_before, alpha, omega, goal, tt
    integer :: iteration

    associate (r => work(:, :, :, 1), shadow => work(:, :, :, 2), p => work(:, :, :, 3), v => work(:, :, :, 4), &
               t => work(:, :, :, 5))
      call scaled_residual(s%lo, s%n, s%centre, s%change, r)
      shadow = r
      p = r
      rho = product_of(s, r, r, comm)
      goal = reduction**2*rho
      do iteration = 1, most_gradients
        if (.not. abs(rho) > 0.0_wp) exit
        call halo%exchange(p)
        call multiply(s%lo, s%n, s%low, s%high, s%centre, p, v)
        alpha = rho/product_of(s, shadow, v, comm)
        r = r - alpha*v
        call halo%exchange(r)
        call multiply(s%lo, s%n, s%low, s%high, s%centre, r, t)
        tt = product_of(s, t, t, comm)
        if (.not. tt > 0.0_wp) exit
        omega = product_of(s, t, r, comm)/tt
        u = u + alpha*p + omega*r
        r = r - omega*t
        count = count + 1
        if (product_of(s, r, r, comm) <= goal) exit
        rho_before = rho
        rho = product_of(s, shadow, r, comm)
        p = r + (rho/rho_before)*(alpha/omega)*(p - omega*v)
      end do
    end associate
  end subroutine gradients

  !> change/centre
  pure subroutine scaled_residual(lo, n, centre, change, r)
    integer, intent(in) :: lo(3), n(3)
    real(wp), intent(in), dimension(lo(1):n(1), lo(2):n(2), lo(3):n(3)) :: centre, change
    real(wp), intent(inout) :: r(-1:n(1) + 2, -1:n(2) + 2, -1:n(3) + 2)

    r(lo(1):n(1), lo(2):n(2), lo(3):n(3)) = change/centre
  end subroutine scaled_residual

  !> y = A x, rows divided by the diagonal; beyond the unknowns y stays as it is.
  pure subroutine multiply(lo, n, low, high, centre, x, y)
    integer, intent(in) :: lo(3), n(3)
    real(wp), intent(in), dimension(lo(1):n(1), 3, lo(2):n(2), lo(3):n(3)) :: low, high
    real(wp), intent(in), dimension(lo(1):n(1), lo(2):n(2), lo(3):n(3)) :: centre
    real(wp), intent(in) :: x(-1:n(1) + 2, -1:n(2) + 2, -1:n(3) + 2)
    real(wp), intent(inout) :: y(-1:n(1) + 2, -1:n(2) + 2, -1:n(3) + 2)

    integer :: i, j, k

    do k = lo(3), n(3)
      do j = lo(2), n(2)
        do i = lo(1), n(1)
          y(i, j, k) = x(i, j, k) - (low(i, 1, j, k)*x(i - 1, j, k) + high(i, 1, j, k)*x(i + 1, j, k) &
            + low(i, 2, j, k)*x(i, j - 1, k) + high(i, 2, j, k)*x(i, j + 1, k) &
            + low(i, 3, j, k)*x(i, j, k - 1) + high(i, 3, j, k)*x(i, j, k + 1))/centre(i, j, k)
        end do
      end do
    end do
  end subroutine multiply

  !> x . y over the unknowns of all ranks.
  function product_of(s, x, y, comm) result(total)
    type(stencil_t), intent(in) :: s
    real(wp), intent(in), contiguous :: x(-1:, -1:, -1:), y(-1:, -1:, -1:)
    type(communicator_t), intent(in) :: comm
    real(wp) :: total

    associate (lo => s%lo, n => s%n)
      total = comm%sum(sum(x(lo(1):n(1), lo(2):n(2), lo(3):n(3))*y(lo(1):n(1), lo(2):n(2), lo(3):n(3))))
    end associate
  end function product_of

end module momentum_solver
