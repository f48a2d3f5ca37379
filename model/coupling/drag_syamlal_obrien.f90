!> Drag on a particle from the terminal velocity of suspensions: Syamlal and O'Brien.
!>
!>   F = (0.63 sqrt(Rs/V) + 4.8)^2/(24 V),    Rs = Re/eps
!>   V = (A - x + sqrt((x - A)^2 + 4 x B))/2,  x = 0.06 Rs,  A = eps^4.14
!>   B = c_1 eps^1.28  eps <= 0.85
!>   B = eps^d_1       eps >  0.85
!>
!> V is the terminal velocity of a suspension over that of a sphere alone (Garside and Al-Dibouni), the rest the drag of a sphere
!> (Dalla Valle: 0.96 of Stokes' in creeping flow). F is the drag force over 3 pi mu d eps |w|, w the slip u_g - v,
!> Re = rho_g eps |w| d/mu; the pressure-gradient force stands beside it (model A). c_1 = 0.8 and d_1 = 2.65 are for want of
!> better: c_1 is there to be set so that the law gives the measured velocity of minimum fluidization, and d_1 so that B does
!> not jump: c_1 0.85^1.28 = 0.85^d_1.
!>
!> Source: Syamlal, O'Brien, Computer simulation of bubbles in a fluidized bed, AIChE Symp. Ser. 85 (1989) 22-31, in the form
!> of MFIX 25.2.1, drag_gs.f, DRAG_SYAM_OBRIEN.
module drag_syamlal_obrien
  use kinds, only: wp
  implicit none
  private
  public :: syamlal_obrien, continuous_d1

  real(wp), parameter :: switch = 0.85_wp  !< void fraction where B changes

contains

  elemental function syamlal_obrien(reynolds, eps, c1, d1) result(factor)
    real(wp), intent(in) :: reynolds  !< Re = rho_g eps |w| d/mu [-]
    real(wp), intent(in) :: eps       !< void fraction [-]
    real(wp), intent(in) :: c1, d1    !< [-]
    real(wp) :: factor                !< F [-]

    real(wp) :: single, a, b, x, v

    single = reynolds/eps
    a = eps**4.14_wp
    if (eps > switch) then
      b = eps**d1
    else
      b = c1*eps**1.28_wp
    end if
    x = 0.06_wp*single
    v = 0.5_wp*(a - x + sqrt((x - a)**2 + 4.0_wp*x*b))
    factor = (0.63_wp*sqrt(single/v) + 4.8_wp)**2/(24.0_wp*v)
  end function syamlal_obrien

  !> The d_1 for which B does not jump.
  elemental function continuous_d1(c1) result(d1)
    real(wp), intent(in) :: c1  !< [-]
    real(wp) :: d1              !< [-]

    d1 = 1.28_wp + log(c1)/log(switch)
  end function continuous_d1

end module drag_syamlal_obrien
