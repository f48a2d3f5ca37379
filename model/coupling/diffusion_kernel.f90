!> Where an amount goes that diffuses for a while along a row of cells.
!>
!> With cells of width h_j, their centres d = (h_j + h_k)/2 apart, an amount q_j of density q_j/h_j obeys
!>
!>   dq_j/dt = sum over neighbours k of D (q_k/h_k - q_j/h_j)/d,    0 < t < 1,    D = max(0, s^2 - c d^2)/2,    (1)
!>
!> with no flux through walls. K(i,j) is what is in cell j in the end of a unit put into cell i. It is positive, sums to one
!> over j, and K(i,j)/h_j = K(j,i)/h_i. In cells of one width its variance is 2 D exactly, whatever the cells: s^2 together with
!> the c h^2 by which amounts have been spread already.
!>
!> (1) is q' = q A, solved by exp(A) = sum over k of e^-x x^k/k! (1 + A/x)^k, with x so large that all terms are positive
!> (Jensen, Skand. Aktuarietidskr. 36 (1953) 87-91). Along a periodic direction the row is unrolled.
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
    real(wp), intent(in) :: s     !< standard deviation [m]
    integer :: reach

    reach = ceiling(far*s/minval(h)) + beyond
  end function kernel_reach

  !> K(i, i - reach:i + reach); 0 beyond walls. What goes farther is left in cell i.
  pure function kernel_row(h, periodic, s, c, i, reach) result(row)
    real(wp), intent(in) :: h(:)          !< widths of the cells [m]
    logical, intent(in) :: periodic       !< whether the last cell is joined to the first
    real(wp), intent(in) :: s             !< standard deviation in the end [m]
    real(wp), intent(in) :: c             !< variance in the beginning, over the cell's width squared [-]
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
    call diffuse(width, s, c, q)
    row = 0.0_wp
    do j = max(first, i - reach), min(last, i + reach)
      row(j - i) = q(j)
    end do
    row(0) = row(0) + (1.0_wp - sum(row))
  end function kernel_row

  !> Solve (1).
  pure subroutine diffuse(h, s, c, q)
    real(wp), intent(in) :: h(:)      !< (n) [m]
    real(wp), intent(in) :: s         !< [m]
    real(wp), intent(in) :: c         !< [-]
    real(wp), intent(inout) :: q(:)   !< (n) any unit

    real(wp) :: distance(size(h) - 1), conductance(0:size(h)), rate, x, share, term(size(h))
    integer :: n, steps, step, k

    n = size(h)
    conductance = 0.0_wp
    distance = 0.5_wp*(h(:n - 1) + h(2:))
    conductance(1:n - 1) = 0.5_wp*max(0.0_wp, s**2 - c*distance**2)/distance
    rate = maxval((conductance(0:n - 1) + conductance(1:n))/h)
    steps = ceiling(rate/longest)
    x = rate/max(1, steps)
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
    real(wp), intent(in) :: conductance(0:)  !< (0:n) D/d of the faces, 0 of walls [m]
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
