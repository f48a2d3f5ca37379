!> Second-order convection: what is added to the upwind value on a face. Limiters keep it bounded; central differences
!> (psi = 1) and the quadratic interpolation of Leonard (psi = (3 + r)/4) are not.
!>
!>   phi_face = phi_C + psi(r)/2 (phi_D - phi_C),   r = (phi_C - phi_U)/(phi_D - phi_C)
!>
!> U, C, D: the second and the first cell upwind of the face and the cell downwind.
!> Sources: Sweby, SIAM J. Numer. Anal. 21 (1984) 995, for the three limiters psi; Leonard, Comput. Methods Appl. Mech. Eng.
!> 19 (1979) 59.
module convection
  use kinds, only: wp
  implicit none
  private
  public :: limiter_index, limited

  integer, parameter :: upwind = 0, van_leer = 1, minmod = 2, superbee = 3, central = 4, quick = 5

contains

  !> The number by which the sweeps know a limiter; -1 for a name that is none.
  pure function limiter_index(name) result(limiter)
    character(len=*), intent(in) :: name
    integer :: limiter

    select case (name)
    case ('upwind')
      limiter = upwind
    case ('van_leer')
      limiter = van_leer
    case ('minmod')
      limiter = minmod
    case ('superbee')
      limiter = superbee
    case ('central')
      limiter = central
    case ('quick')
      limiter = quick
    case default
      limiter = -1
    end select
  end function limiter_index

  !> psi(r)/2 (phi_D - phi_C) for a row of faces.
  pure subroutine limited(limiter, n, upper, step, addition)
    integer, intent(in) :: limiter, n
    real(wp), intent(in) :: upper(n)      !< phi_C - phi_U
    real(wp), intent(in) :: step(n)       !< phi_D - phi_C
    real(wp), intent(out) :: addition(n)

    integer :: i
    real(wp) :: both

    select case (limiter)
    case (van_leer)  ! (r + |r|)/(1 + |r|)/2 step: the harmonic mean of the two slopes, halved
      do i = 1, n
        both = max(upper(i)*step(i), 0.0_wp)
        addition(i) = both/merge(upper(i) + step(i), 1.0_wp, both > 0.0_wp)
      end do
    case (minmod)
      do i = 1, n
        addition(i) = 0.5_wp*smaller(upper(i), step(i))
      end do
    case (superbee)
      do i = 1, n
        addition(i) = 0.5_wp*larger(smaller(2*upper(i), step(i)), smaller(upper(i), 2*step(i)))
      end do
    case (central)
      addition = 0.5_wp*step
    case (quick)
      addition = 0.375_wp*step + 0.125_wp*upper
    case default
      addition = 0.0_wp
    end select
  end subroutine limited

  !> The smaller of two slopes of the same sign, else 0.
  elemental function smaller(x, y)
    real(wp), intent(in) :: x, y
    real(wp) :: smaller

    smaller = 0.5_wp*(sign(1.0_wp, x) + sign(1.0_wp, y))*min(abs(x), abs(y))
  end function smaller

  !> The larger of two slopes of the same sign.
  elemental function larger(x, y)
    real(wp), intent(in) :: x, y
    real(wp) :: larger

    larger = sign(1.0_wp, x)*max(abs(x), abs(y))
  end function larger

end module convection
