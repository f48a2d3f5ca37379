!> Drag on a particle of a packed bed from lattice Boltzmann simulation, in the form of Di Felice: Rong, Dong, Yu.
!>
!>   F = (0.63 sqrt(Re) + 4.8)^2/24 eps^-chi,    chi = 2.65 (eps + 1) - (5.3 - 3.5 eps) eps^2 exp(-(1.5 - log10 Re)^2/2)
!>
!> F is the drag force over 3 pi mu d eps |w|, w the slip u_g - v, Re = rho_g eps |w| d/mu; the pressure-gradient
!> force stands beside it (model A).
!>
!> Source: Rong, Dong, Yu, Lattice-Boltzmann simulation of fluid flow through packed beds of uniform spheres: effect of porosity,
!> Chem. Eng. Sci. 99 (2013) 44-58, in the form of PhasicFlowPlus, Rong.
module drag_rong
  use drag_di_felice, only: dalla_valle, bell
  use kinds, only: wp
  implicit none
  private
  public :: rong

contains

  elemental function rong(reynolds, eps) result(factor)
    real(wp), intent(in) :: reynolds  !< Re = rho_g eps |w| d/mu [-]
    real(wp), intent(in) :: eps       !< void fraction [-]
    real(wp) :: factor                !< F [-]

    factor = dalla_valle(reynolds)*eps**((5.3_wp - 3.5_wp*eps)*eps**2*bell(reynolds) - 2.65_wp*(eps + 1.0_wp))
  end function rong

end module drag_rong
