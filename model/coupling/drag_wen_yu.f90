!> Drag on a particle of a dilute suspension: Wen and Yu.
!>
!>   F = (1 + 0.15 Re^0.687) eps^-3.65     Re <= 1000     (Schiller-Naumann times the voidage function)
!>   F = (0.44/24) Re eps^-3.65            Re > 1000      (constant drag coefficient)
!>
!> F is the drag force over 3 pi mu d eps |w|, w the slip u_g - v, Re = rho_g eps |w| d/mu; the pressure-gradient
!> force stands beside it (model A). At eps = 1 it is the drag of a single sphere.
!>
!> Source: Wen and Yu, Mechanics of fluidization, Chem. Eng. Prog. Symp. Ser. 62 (1966) 100-111, in the form of
!> MFIX 25.2.1, drag_gs.f, DRAG_WEN_YU.
module drag_wen_yu
  use kinds, only: wp
  implicit none
  private
  public :: wen_yu

contains

  elemental function wen_yu(reynolds, eps) result(factor)
    real(wp), intent(in) :: reynolds  !< Re = rho_g eps |w| d/mu [-]
    real(wp), intent(in) :: eps       !< void fraction [-]
    real(wp) :: factor                !< F [-]

    if (reynolds > 1000.0_wp) then
      factor = 0.44_wp/24.0_wp*reynolds*eps**(-3.65_wp)
    else
      factor = (1.0_wp + 0.15_wp*reynolds**0.687_wp)*eps**(-3.65_wp)
    end if
  end function wen_yu

end module drag_wen_yu
