!> Drag on a particle at any void fraction from lattice Boltzmann simulation: Cello, Di Renzo, Di Maio.
!>
!>   F = K_1 + K_2 eps^4 + K_3 (1 - eps^4),    K_0 = phi/(1 + 3 eps),    phi = 1 - eps
!>   K_1 = (1 + 128 K_0 + 715 K_0^2)/(eps^2 (1 + 49.5 K_0))
!>   K_2 = (1 + 0.130 Re + 6.66e-4 Re^2)/(1 + 3.42e-2 Re + 6.92e-6 Re^2) - 1
!>   K_3 = 2 Re^2/(1 + Re) (-410 eps + 9.20e7 Re K_0^20 + 1900 eps^2 - 6.60e-2 Re)
!>         /(6600 eps + 4.92e-4 Re - 4.30e4 eps^2 - 1.31e-4 Re^2 + 7.38e4 eps^3)
!>
!> F is the drag force over 3 pi mu d eps |w|, w the slip u_g - v, Re = rho_g eps |w| d/mu; the pressure-gradient
!> force stands beside it (model A). PhasicFlowPlus lacks the -1 of K_2: a sphere alone would feel twice Stokes' drag.
!> The denominator of K_3 vanishes at Re = 890 for eps = 0.3, at Re = 1900 for eps = 0.4. So K_3 never sees an eps below 0.36,
!> close packing, and beyond Re = 1000 K_2 and K_3 grow as Re: a drag coefficient that does not change any more.
!>
!> Source: Cello, Di Renzo, Di Maio, A semi-empirical model for the drag force and fluid-particle interaction in polydisperse
!> suspensions, Chem. Eng. Sci. 65 (2010) 3128-3139, in the form of PhasicFlowPlus 3d409e87, Cello, with the -1.
module drag_cello
  use kinds, only: wp
  implicit none
  private
  public :: cello

  real(wp), parameter :: fitted = 1000.0_wp  !< largest Re that K_2 and K_3 see
  real(wp), parameter :: densest = 0.36_wp   !< least eps that K_3 sees

contains

  elemental function cello(reynolds, eps) result(factor)
    real(wp), intent(in) :: reynolds  !< Re = rho_g eps |w| d/mu [-]
    real(wp), intent(in) :: eps       !< void fraction [-]
    real(wp) :: factor                !< F [-]

    real(wp) :: k0, k1, k2, re

    k0 = max(0.0_wp, 1.0_wp - eps)/(1.0_wp + 3.0_wp*eps)
    k1 = (1.0_wp + k0*(128.0_wp + 715.0_wp*k0))/(eps**2*(1.0_wp + 49.5_wp*k0))
    re = min(reynolds, fitted)
    k2 = (1.0_wp + re*(0.130_wp + 6.66e-4_wp*re))/(1.0_wp + re*(3.42e-2_wp + 6.92e-6_wp*re)) - 1.0_wp
    factor = k1 + max(1.0_wp, reynolds/fitted)*(k2*eps**4 + crowd(re, max(eps, densest))*max(0.0_wp, 1.0_wp - eps**4))
  end function cello

  !> K_3.
  elemental function crowd(reynolds, eps) result(k3)
    real(wp), intent(in) :: reynolds, eps  !< [-]
    real(wp) :: k3                         !< [-]

    real(wp) :: k0, numerator, denominator

    k0 = (1.0_wp - eps)/(1.0_wp + 3.0_wp*eps)
    numerator = eps*(1900.0_wp*eps - 410.0_wp) + reynolds*(9.20e7_wp*k0**20 - 6.60e-2_wp)
    denominator = eps*(6600.0_wp + eps*(7.38e4_wp*eps - 4.30e4_wp)) + reynolds*(4.92e-4_wp - 1.31e-4_wp*reynolds)
    k3 = 2.0_wp*reynolds**2/(1.0_wp + reynolds)*numerator/denominator
  end function crowd

end module drag_cello
