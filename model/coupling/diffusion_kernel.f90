!> Where an amount goes that diffuses for a while along a row of cells.
!>
!> With cells of width h_j and their centres (h_j + h_k)/2 apart, an amount q_j of density q_j/h_j obeys
!>
!>   dq_j/dt = sum over neighbours k of (q_k/h_k - q_j/h_j)/((h_j + h_k)/2),    0 < t < s^2/2,                (1)
!>
!> with no flux through walls. K(i,j) is what is in cell j in the end of a unit put into cell i. It is positive, sums to one
!> over j, and K(i,j)/h_j = K(j,i)/h_i. In cells of one width its variance is s^2 exactly, whatever s/h.
!>
!> (1) is q' = q A, solved by exp(t A) = sum over k of e^-x x^k/k! (1 + A/a)^k, x = a t, with a so large that all terms are
!> positive (Jensen, Skand. Aktuarietidskr. 36 (1953) 87-91). Along a periodic direction the row is unrolled.
module diffusion_kernel
  use kinds, only: wp
  implicit none
  private
  public :: kernel_row, kernel_reach

  real(wp), parameter :: far = 7.0_wp         !< standard deviations, and
  integer, parameter :: beyond = 5            !< cells, beyond which lies less than 1e-10
  real(wp), parameter :: longest = 100.0_wp   !< x of one series: e^-x must not underflow
  real(wp), parameter :: smallest = 1.0e-20_wp  !< term of the series

contains

  !> How many cells on either side K reaches, from any cell.
  pure function kernel_reach(h, s) result(reach)
    real(wp), intent(in) :: h(:)  !< widths of the cells [m]
    real(wp), intent(in) :: s     !< standard deviation of the kernel [m]
    integer :: reach

    reach = ceiling(far*s/minval(h)) + beyond
  end function kernel_reach

  !> K(i, i - reach:i + reach); 0 beyond walls. What goes farther is left in cell i.
  pure function kernel_row(h, periodic, s, i, reach) result(row)
    real(wp), intent(in) :: h(:)          !< widths of the cells [m]
    logical, intent(in) :: periodic       !< whether the last cell is joined to the first
    real(wp), intent(in) :: s             !< standard deviation of the kernel [m]
    integer, intent(in) :: i, reach
    real(wp) :: row(-reach:reach)

    real(wp), allocatable :: q(:), width(:)
    integer :: first, last, j

    ! A row twice as long as what is kept: its ends are not felt.
    first = i - 2*reach
    last = i + 2*reach
    if (.not. periodic) first = max(1, first)
    if (.not. periodic) last = min(size(h), last)
    allocate (q(first:last), source=0.0_wp)
    width = [(h(modulo(j - 1, size(h)) + 1), j=first, last)]
    q(i) = 1.0_wp
    call diffuse(width, 0.5_wp*s**2, q)
    row = 0.0_wp
    do j = max(first, i - reach), min(last, i + reach)
      row(j - i) = q(j)
    end do
    row(0) = row(0) + (1.0_wp - sum(row))
  end function kernel_row

  !> Solve (1) over a time t.
  pure subroutine diffuse(h, t, q)
    real(wp), intent(in) :: h(:)      !< (n) [m]
    real(wp), intent(in) :: t         !< [m2]
    real(wp), intent(inout) :: q(:)   !< (n) any unit

    real(wp) :: conductance(0:size(h)), rate, x, share, term(size(h))
    integer :: n, steps, step, k

    n = size(h)
    conductance = 0.0_wp
    conductance(1:n - 1) = 2.0_wp/(h(:n - 1) + h(2:))
    rate = maxval((conductance(0:n - 1) + conductance(1:n))/h)
    steps = max(1, ceiling(rate*t/longest))
    x = rate*t/steps
    do step = 1, steps
      term = q
      share = exp(-x)
      q = share*term
      k = 0
      do while (k < x .or. share > smallest)
        k = k + 1
        term = term + exchange(h, conductance, term)/rate
        share = share*x/k
        q = q + share*term
      end do
    end do
  end subroutine diffuse

  !> The right-hand side of (1).
  pure function exchange(h, conductance, q) result(change)
    real(wp), intent(in) :: h(:)             !< (n) [m]
    real(wp), intent(in) :: conductance(0:)  !< (0:n) of the faces, 0 of walls [1/m]
    real(wp), intent(in) :: q(:)             !< (n)
    real(wp) :: change(size(h))

    real(wp) :: flux(0:size(h))
    integer :: n

    n = size(h)
    flux = 0.0_wp
    flux(1:n - 1) = conductance(1:n - 1)*(q(:n - 1)/h(:n - 1) - q(2:)/h(2:))
    change = flux(0:n - 1) - flux(1:n)
  end function exchange

end module diffusion_kernel
