!> Drag on a particle at any void fraction from lattice Boltzmann simulation: Beetstra, van der Hoef, Kuipers.
!>
!>   F = 10 phi/eps^2 + eps^2 (1 + 1.5 sqrt(phi))
!>     + 0.413 Re/(24 eps^2) (1/eps + 3 eps phi + 8.4 Re^-0.343) / (1 + 10^(3 phi) Re^-(1 + 4 phi)/2),  phi = 1 - eps
!>
!> F is the drag force over 3 pi mu d eps |w|, w the slip u_g - v, Re = rho_g eps |w| d/mu; the pressure-gradient
!> force stands beside it (model A). This is the law of equal spheres, with the diameter of the particle itself.
!>
!> Source: Beetstra, van der Hoef, Kuipers, Drag force of intermediate Reynolds number flow past mono- and
!> bidisperse arrays of spheres, AIChE J. 53 (2007) 489-501, in the form of CFDEMcoupling-PFM, BeetstraDrag::F.
module drag_beetstra
  use kinds, only: wp
  implicit none
  private
  public :: beetstra

contains

  elemental function beetstra(reynolds, eps) result(factor)
    real(wp), intent(in) :: reynolds  !< Re = rho_g eps |w| d/mu [-]
    real(wp), intent(in) :: eps       !< void fraction [-]
    real(wp) :: factor                !< F [-]

    real(wp) :: phi, viscous, inertial, power

    phi = max(0.0_wp, 1.0_wp - eps)
    viscous = 10.0_wp*phi/eps**2 + eps**2*(1.0_wp + 1.5_wp*sqrt(phi))
    ! Numerator and denominator are both multiplied by Re^(1 + 4 phi)/2, so that Re = 0 is no exception.
    power = reynolds**(0.5_wp + 2.0_wp*phi)
    inertial = (reynolds*(1.0_wp/eps + 3.0_wp*eps*phi) + 8.4_wp*reynolds**0.657_wp)*power &
      /(power + 10.0_wp**(3.0_wp*phi))
    factor = viscous + 0.413_wp/(24.0_wp*eps**2)*inertial
  end function beetstra

end module drag_beetstra
