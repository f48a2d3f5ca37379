!> Drag on a particle of a fixed array from simulations that resolve the flow around each: Tenneti, Garg, Subramaniam.
!>
!>   F = eps ((1 + 0.15 Re^0.687)/eps^3 + 5.81 phi/eps^3 + 0.48 phi^(1/3)/eps^4
!>            + phi^3 Re (0.95 + 0.61 phi^3/eps^2)),    phi = 1 - eps
!>
!> F is the drag force over 3 pi mu d eps |w|, w the slip u_g - v, Re = rho_g eps |w| d/mu; the pressure-gradient
!> force stands beside it (model A). The bracket is the whole force, mean pressure gradient included: the eps before it leaves the
!> drag. Without that (MFIX) a packed bed would resist 1/eps times as much: 18.1 in creeping flow at eps = 0.6, where
!> Beetstra has 11.8 and the law with eps 10.9.
!>
!> Source: Tenneti, Garg, Subramaniam, Drag law for monodisperse gas-solid systems using particle-resolved direct numerical
!> simulation of flow past fixed assemblies of spheres, Int. J. Multiphase Flow 37 (2011) 1072-1092; the bracket in the form of
!> MFIX 25.2.1, drag_gs.f, DRAG_TGS.
module drag_tenneti
  use kinds, only: wp
  implicit none
  private
  public :: tenneti

contains

  elemental function tenneti(reynolds, eps) result(factor)
    real(wp), intent(in) :: reynolds  !< Re = rho_g eps |w| d/mu [-]
    real(wp), intent(in) :: eps       !< void fraction [-]
    real(wp) :: factor                !< F [-]

    real(wp) :: phi, single, crowd, inertial

    phi = max(0.0_wp, 1.0_wp - eps)
    single = (1.0_wp + 0.15_wp*reynolds**0.687_wp)/eps**2
    crowd = 5.81_wp*phi/eps**2 + 0.48_wp*phi**(1.0_wp/3.0_wp)/eps**3
    inertial = eps*phi**3*reynolds*(0.95_wp + 0.61_wp*phi**3/eps**2)
    factor = single + crowd + inertial
  end function tenneti

end module drag_tenneti
