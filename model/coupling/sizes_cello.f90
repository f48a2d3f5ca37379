!> Drag among particles of several sizes: Cello, Di Renzo, Di Maio.
!>
!>   F_i = (y + (phi/eps) (phi - 0.27)/0.73 (y^2 - y)/S) F(Re, eps),    y = d_i/<d>,    Re = rho_g eps |w| <d>/mu
!>   S = sum over sizes of x_k y_k, x_k their share of the solids' volume
!>
!> <d> is the Sauter mean of the particles around, phi = 1 - eps. F_i is the drag force over 3 pi mu d_i eps |w|, the
!> pressure-gradient force beside it (model A). Far from what was fitted, for fines beyond close packing and for grains of dozens
!> of <d>, the bracket turns negative: it never falls below y/10.
!>
!> Source: Cello, Di Renzo, Di Maio, A semi-empirical model for the drag force and fluid-particle interaction in polydisperse
!> suspensions, Chem. Eng. Sci. 65 (2010) 3128-3139, in the form of PhasicFlowPlus, celloPolydisperseSphereDrag.
module sizes_cello
  use kinds, only: wp
  implicit none
  private
  public :: among_sizes_cello

contains

  elemental function among_sizes_cello(factor, eps, y, spread) result(own)
    real(wp), intent(in) :: factor  !< F of particles of the mean size [-]
    real(wp), intent(in) :: eps     !< void fraction [-]
    real(wp), intent(in) :: y       !< d_i/<d> [-]
    real(wp), intent(in) :: spread  !< S, 1 for one size, more for several [-]
    real(wp) :: own                 !< F_i [-]

    real(wp) :: phi

    phi = max(0.0_wp, 1.0_wp - eps)
    own = factor*y*max(0.1_wp, 1.0_wp + phi/eps*(phi - 0.27_wp)/0.73_wp*(y - 1.0_wp)/spread)
  end function among_sizes_cello

end module sizes_cello
