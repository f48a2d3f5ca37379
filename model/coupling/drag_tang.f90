!> Drag on a particle of a fixed array from simulations that resolve the flow around each: Tang and others.
!>
!>   F = 10 phi/eps^2 + eps^2 (1 + 1.5 sqrt(phi))
!>     + Re (0.11 phi (1 + phi) - 0.00456/eps^4 + (0.169 eps + 0.0644/eps^4) Re^-0.343),    phi = 1 - eps
!>
!> F is the drag force over 3 pi mu d eps |w|, w the slip u_g - v, Re = rho_g eps |w| d/mu; the pressure-gradient
!> force stands beside it (model A). The fit ends at Re = 1000; dense arrays would be pushed upstream from Re = 3000 on.
!> Beyond 1000 the last bracket is therefore that of 1000: a drag coefficient that does not change any more.
!>
!> Source: Tang, Peters, Kuipers, Kriebitzsch, van der Hoef, A new drag correlation from fully resolved simulations of flow past
!> monodisperse static arrays of spheres, AIChE J. 61 (2015) 688-698, in the form of MFIX 25.2.1, drag_gs.f, DRAG_TPKKV.
module drag_tang
  use kinds, only: wp
  implicit none
  private
  public :: tang

  real(wp), parameter :: fitted = 1000.0_wp  !< largest Re of the fit

contains

  elemental function tang(reynolds, eps) result(factor)
    real(wp), intent(in) :: reynolds  !< Re = rho_g eps |w| d/mu [-]
    real(wp), intent(in) :: eps       !< void fraction [-]
    real(wp) :: factor                !< F [-]

    real(wp) :: phi, viscous, re, inertial

    phi = max(0.0_wp, 1.0_wp - eps)
    viscous = 10.0_wp*phi/eps**2 + eps**2*(1.0_wp + 1.5_wp*sqrt(phi))
    re = min(reynolds, fitted)
    inertial = re*(0.11_wp*phi*(1.0_wp + phi) - 0.00456_wp/eps**4) + (0.169_wp*eps + 0.0644_wp/eps**4)*re**0.657_wp
    factor = viscous + inertial*max(1.0_wp, reynolds/fitted)
  end function tang

end module drag_tang
