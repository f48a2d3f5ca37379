!> Drag on a particle at any void fraction: Gidaspow.
!>
!>   F = Ergun       eps <= 0.8
!>   F = Wen-Yu      eps >  0.8
!>
!> The law jumps at eps = 0.8: Ergun over Wen-Yu is there 1.13, 1.06, 1.06, 1.73 at Re = 0.1, 1, 10, 100.
!>
!> Source: Gidaspow, Multiphase Flow and Fluidization, Academic Press (1994), in the form of MFIX 25.2.1,
!> drag_gs.f, DRAG_GIDASPOW.
module drag_gidaspow
  use drag_ergun, only: ergun
  use drag_wen_yu, only: wen_yu
  use kinds, only: wp
  implicit none
  private
  public :: gidaspow

contains

  elemental function gidaspow(reynolds, eps) result(factor)
    real(wp), intent(in) :: reynolds  !< Re = rho_g eps |w| d/mu [-]
    real(wp), intent(in) :: eps       !< void fraction [-]
    real(wp) :: factor                !< drag force over 3 pi mu d eps |w| [-]

    if (eps > 0.8_wp) then
      factor = wen_yu(reynolds, eps)
    else
      factor = ergun(reynolds, eps)
    end if
  end function gidaspow

end module drag_gidaspow
