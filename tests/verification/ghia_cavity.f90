!> Velocities on the middle lines of a square cavity: Ghia, Ghia and Shin, J. Comput. Phys. 48 (1982) 387, tables I and II, as
!> MFIX has them (tests/tfm/TFM03); edge and lid are 1. The ends of the lines, where the walls are, are left out.
module ghia_cavity
  use kinds, only: wp
  implicit none
  private

  real(wp), parameter, public :: reynolds(3) = [100.0_wp, 400.0_wp, 1000.0_wp]

  !> u(y) at x = 1/2.
  real(wp), parameter, public :: y(15) = [ &
      0.9766_wp, 0.9688_wp, 0.9609_wp, 0.9531_wp, 0.8516_wp, 0.7344_wp, 0.6172_wp, 0.5_wp, 0.4531_wp, 0.2813_wp, 0.1719_wp, &
      0.1016_wp, 0.0703_wp, 0.0625_wp, 0.0547_wp]
  real(wp), parameter, public :: u(15, 3) = reshape([ &
      0.84123_wp, 0.78871_wp, 0.73722_wp, 0.68717_wp, 0.23151_wp, 0.00332_wp, -0.13641_wp, -0.20581_wp, -0.2109_wp, &
      -0.15662_wp, -0.1015_wp, -0.06434_wp, -0.04775_wp, -0.04192_wp, -0.03717_wp, &
      0.75837_wp, 0.68439_wp, 0.61756_wp, 0.55892_wp, 0.29093_wp, 0.16256_wp, 0.02135_wp, -0.11477_wp, -0.17119_wp, &
      -0.32726_wp, -0.24299_wp, -0.14612_wp, -0.10338_wp, -0.09266_wp, -0.08186_wp, &
      0.65928_wp, 0.57492_wp, 0.51117_wp, 0.46604_wp, 0.33304_wp, 0.18719_wp, 0.05702_wp, -0.0608_wp, -0.10648_wp, &
      -0.27805_wp, -0.38289_wp, -0.2973_wp, -0.2222_wp, -0.20196_wp, -0.18109_wp], [15, 3])

  !> v(x) at y = 1/2.
  real(wp), parameter, public :: x(15) = [ &
      0.9688_wp, 0.9609_wp, 0.9531_wp, 0.9453_wp, 0.9063_wp, 0.8594_wp, 0.8047_wp, 0.5_wp, 0.2344_wp, 0.2266_wp, 0.1563_wp, &
      0.0938_wp, 0.0781_wp, 0.0703_wp, 0.0625_wp]
  real(wp), parameter, public :: v(15, 3) = reshape([ &
      -0.05906_wp, -0.07391_wp, -0.08864_wp, -0.10313_wp, -0.16914_wp, -0.22445_wp, -0.24533_wp, 0.05454_wp, 0.17527_wp, &
      0.17507_wp, 0.16077_wp, 0.12317_wp, 0.1089_wp, 0.10091_wp, 0.09233_wp, &
      -0.12146_wp, -0.15663_wp, -0.19254_wp, -0.22847_wp, -0.23827_wp, -0.44993_wp, -0.38598_wp, 0.05186_wp, 0.30174_wp, &
      0.30203_wp, 0.28124_wp, 0.22965_wp, 0.2092_wp, 0.19713_wp, 0.1836_wp, &
      -0.21388_wp, -0.27669_wp, -0.33714_wp, -0.39188_wp, -0.5155_wp, -0.42665_wp, -0.31966_wp, 0.02526_wp, 0.32235_wp, &
      0.33075_wp, 0.37095_wp, 0.32627_wp, 0.30353_wp, 0.29012_wp, 0.27485_wp], [15, 3])

  !> A misprint, long known: v at Re 400 is out of line with its neighbours.
  integer, parameter, public :: misprint(2) = [5, 2]

end module ghia_cavity
