!> Drag among particles of several sizes: Beetstra, van der Hoef, Kuipers.
!>
!>   F_i = (y + 0.064 y^3) F(Re, eps),    y = d_i/<d>,    Re = rho_g eps |w| <d>/mu
!>
!> <d> is the Sauter mean of the particles around. F_i is the drag force over 3 pi mu d_i eps |w|, the pressure-gradient
!> force beside it (model A); the paper's whole force is (eps y + phi y^2 + 0.064 eps y^3) F/eps. Particles of one size
!> get 1.064 F, as ever narrower distributions do: the term is not dropped, since a law that jumps when the last other grain leaves
!> would be none.
!>
!> Source: Beetstra, van der Hoef, Kuipers, Drag force of intermediate Reynolds number flow past mono- and bidisperse arrays
!> of spheres, AIChE J. 53 (2007) 489-501, in the form of CFDEMcoupling-PFM, BeetstraDragPoly.
module sizes_beetstra
  use kinds, only: wp
  implicit none
  private
  public :: among_sizes_beetstra

contains

  elemental function among_sizes_beetstra(factor, y) result(own)
    real(wp), intent(in) :: factor  !< F of particles of the mean size [-]
    real(wp), intent(in) :: y       !< d_i/<d> [-]
    real(wp) :: own                 !< F_i [-]

    own = (y + 0.064_wp*y**3)*factor
  end function among_sizes_beetstra

end module sizes_beetstra
