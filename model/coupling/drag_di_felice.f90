!> Drag on a particle from a voidage function whose exponent follows the flow: Di Felice.
!>
!>   F = F_1 eps^-chi,    chi = 3.7 - 0.65 exp(-(1.5 - log10 Re)^2/2)
!>   F_1 = (0.63 sqrt(Re) + 4.8)^2/24    di_felice     (Dalla Valle: 0.96 of Stokes' in creeping flow)
!>   F_1 = 1 + 0.15 Re^0.687             di_felice_sn  (Schiller and Naumann; so in MFIX)
!>
!> F is the drag force over 3 pi mu d eps |w|, w the slip u_g - v, Re = rho_g eps |w| d/mu; the pressure-gradient
!> force stands beside it (model A).
!>
!> Source: Di Felice, The voidage function for fluid-particle interaction systems, Int. J. Multiphase Flow 20 (1994) 153-159, in
!> the form of CFDEMcoupling-PFM and of MFIX 25.2.1, drag_gs.f, DRAG_DIFELICE.
module drag_di_felice
  use kinds, only: wp
  implicit none
  private
  public :: di_felice, di_felice_sn, dalla_valle, bell

contains

  elemental function di_felice(reynolds, eps) result(factor)
    real(wp), intent(in) :: reynolds  !< Re = rho_g eps |w| d/mu [-]
    real(wp), intent(in) :: eps       !< void fraction [-]
    real(wp) :: factor                !< F [-]

    factor = dalla_valle(reynolds)*eps**(0.65_wp*bell(reynolds) - 3.7_wp)
  end function di_felice

  elemental function di_felice_sn(reynolds, eps) result(factor)
    real(wp), intent(in) :: reynolds  !< Re = rho_g eps |w| d/mu [-]
    real(wp), intent(in) :: eps       !< void fraction [-]
    real(wp) :: factor                !< F [-]

    factor = (1.0_wp + 0.15_wp*reynolds**0.687_wp)*eps**(0.65_wp*bell(reynolds) - 3.7_wp)
  end function di_felice_sn

  !> Drag on a sphere alone over that of Stokes, with the drag coefficient (0.63 + 4.8/sqrt(Re))^2.
  elemental function dalla_valle(reynolds) result(factor)
    real(wp), intent(in) :: reynolds  !< [-]
    real(wp) :: factor                !< [-]

    factor = (0.63_wp*sqrt(reynolds) + 4.8_wp)**2/24.0_wp
  end function dalla_valle

  !> exp(-(1.5 - log10 Re)^2/2), which vanishes at either end.
  elemental function bell(reynolds)
    real(wp), intent(in) :: reynolds  !< [-]
    real(wp) :: bell                  !< [-]

    bell = exp(-0.5_wp*(1.5_wp - log10(max(reynolds, 1.0e-9_wp)))**2)
  end function bell

end module drag_di_felice
