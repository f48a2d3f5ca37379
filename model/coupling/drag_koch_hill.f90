!> Drag on a particle at any void fraction from lattice Boltzmann simulation: Koch and Hill.
!>
!>   F = eps (F_0 + F_3 Re/2),    F_3 = 0.0673 + 0.212 phi + 0.0232/eps^5,    phi = 1 - eps
!>   F_0 = (1 + 3 sqrt(phi/2) + (135/64) phi ln phi + 16.14 phi)/(1 + 0.681 phi - 8.48 phi^2 + 8.16 phi^3)   phi < 0.4
!>   F_0 = 10 phi/eps^3                                                                                      phi >= 0.4
!>
!> F is the drag force over 3 pi mu d eps |w|, w the slip u_g - v, Re = rho_g eps |w| d/mu; the pressure-gradient
!> force stands beside it (model A). F_0 jumps by 1 % at phi = 0.4. The term linear in Re, that of fast flow, is used for slow
!> flow, too, where Hill, Koch and Ladd have Re^2: a sphere alone feels 1 + 0.045 Re.
!>
!> Source: Koch, Hill, Inertial effects in suspension and porous-media flows, Annu. Rev. Fluid Mech. 33 (2001) 619-647, in the
!> form of CFDEMcoupling-PFM, KochHillDrag.
module drag_koch_hill
  use kinds, only: wp
  implicit none
  private
  public :: koch_hill

contains

  elemental function koch_hill(reynolds, eps) result(factor)
    real(wp), intent(in) :: reynolds  !< Re = rho_g eps |w| d/mu [-]
    real(wp), intent(in) :: eps       !< void fraction [-]
    real(wp) :: factor                !< F [-]

    real(wp) :: phi, viscous, inertial

    phi = max(0.0_wp, 1.0_wp - eps)
    if (phi < 0.4_wp) then
      ! phi ln phi vanishes with phi; the logarithm alone does not.
      viscous = (1.0_wp + 3.0_wp*sqrt(0.5_wp*phi) + 135.0_wp/64.0_wp*phi*log(max(phi, tiny(phi))) + 16.14_wp*phi) &
        /(1.0_wp + phi*(0.681_wp + phi*(-8.48_wp + phi*8.16_wp)))
    else
      viscous = 10.0_wp*phi/eps**3
    end if
    inertial = 0.5_wp*reynolds*(0.0673_wp + 0.212_wp*phi + 0.0232_wp/eps**5)
    factor = eps*(viscous + inertial)
  end function koch_hill

end module drag_koch_hill
