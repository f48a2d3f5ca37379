!> Drag on a particle of a packed bed: Ergun.
!>
!>   F = (150 (1 - eps) + 1.75 Re) / (18 eps^2)
!>
!> F is the drag force over 3 pi mu d eps |w|, w the slip u_g - v, Re = rho_g eps |w| d/mu; the pressure-gradient
!> force stands beside it (model A). A particle alone in creeping flow would feel none.
!>
!> Source: Ergun, Fluid flow through packed columns, Chem. Eng. Prog. 48 (1952) 89-94, written as a drag as in
!> MFIX 25.2.1, drag_gs.f, DRAG_GIDASPOW.
module drag_ergun
  use kinds, only: wp
  implicit none
  private
  public :: ergun

contains

  elemental function ergun(reynolds, eps) result(factor)
    real(wp), intent(in) :: reynolds  !< Re = rho_g eps |w| d/mu [-]
    real(wp), intent(in) :: eps       !< void fraction [-]
    real(wp) :: factor                !< F [-]

    factor = (150.0_wp*max(0.0_wp, 1.0_wp - eps) + 1.75_wp*reynolds)/(18.0_wp*eps**2)
  end function ergun

end module drag_ergun
