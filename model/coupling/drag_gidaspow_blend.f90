!> Drag on a particle at any void fraction: Gidaspow without the jump.
!>
!>   F = psi F_Wen-Yu + (1 - psi) F_Ergun,    psi = 1/2 + atan(262.5 (eps - 0.8))/pi
!>
!> Far from eps = 0.8 psi nears its end slowly: a single sphere feels 0.994 of Wen-Yu.
!>
!> Source: Gidaspow, Multiphase Flow and Fluidization, Academic Press (1994), joined as in MFIX 25.2.1, drag_gs.f,
!> DRAG_GIDASPOW_BLEND.
module drag_gidaspow_blend
  use constants, only: pi
  use drag_ergun, only: ergun
  use drag_wen_yu, only: wen_yu
  use kinds, only: wp
  implicit none
  private
  public :: gidaspow_blend

contains

  elemental function gidaspow_blend(reynolds, eps) result(factor)
    real(wp), intent(in) :: reynolds  !< Re = rho_g eps |w| d/mu [-]
    real(wp), intent(in) :: eps       !< void fraction [-]
    real(wp) :: factor                !< drag force over 3 pi mu d eps |w| [-]

    real(wp) :: psi

    psi = 0.5_wp + atan(262.5_wp*(eps - 0.8_wp))/pi
    factor = psi*wen_yu(reynolds, eps) + (1.0_wp - psi)*ergun(reynolds, eps)
  end function gidaspow_blend

end module drag_gidaspow_blend
