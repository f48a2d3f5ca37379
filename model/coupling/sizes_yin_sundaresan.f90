!> Drag among particles of several sizes: Yin and Sundaresan, without drag between particles.
!>
!>   F_i = 1/eps + (F(Re, eps) - 1/eps)(a y + (1 - a) y^2),    y = d_i/<d>,    Re = rho_g eps |w| <d>/mu
!>   a = 1 - 2.66 phi + 9.096 phi^2 - 11.338 phi^3,    phi = 1 - eps
!>
!> <d> is the Sauter mean of the particles around. F_i is the drag force over 3 pi mu d_i eps |w|, the pressure-gradient
!> force beside it (model A). The fit of a turns negative at phi = 0.65: it is held at 0 there, lest fines be driven upstream.
!>
!> Source: Yin, Sundaresan, Fluid-particle drag in low-Reynolds-number polydisperse gas-solid suspensions, AIChE J. 55 (2009)
!> 1352-1368; Holloway, Yin, Sundaresan, AIChE J. 56 (2010) 1995-2004, in the form of MFIX, HYS_drag.pdf.
module sizes_yin_sundaresan
  use kinds, only: wp
  implicit none
  private
  public :: among_sizes_yin_sundaresan

contains

  elemental function among_sizes_yin_sundaresan(factor, eps, y) result(own)
    real(wp), intent(in) :: factor  !< F of particles of the mean size [-]
    real(wp), intent(in) :: eps     !< void fraction [-]
    real(wp), intent(in) :: y       !< d_i/<d> [-]
    real(wp) :: own                 !< F_i [-]

    real(wp) :: phi, a

    phi = max(0.0_wp, 1.0_wp - eps)
    a = max(0.0_wp, 1.0_wp + phi*(-2.66_wp + phi*(9.096_wp - phi*11.338_wp)))
    own = 1.0_wp/eps + (factor - 1.0_wp/eps)*y*(a + (1.0_wp - a)*y)
  end function among_sizes_yin_sundaresan

end module sizes_yin_sundaresan
