!> Spheres of many sizes for the beds of bench_contacts, and a place for each.
module powders
  use constants, only: pi
  use kinds, only: wp
  use packing, only: box_t, pack_spheres
  use random_numbers, only: random_t
  use sphere_pairs, only: spheres_t
  implicit none
  private
  public :: equal_volumes, log_normal, packed

contains

  !> A diameter of the log-normal distribution with median 1 mm and spread 0.35, clipped to [0.5, 2] mm, at a quantile [m].
  pure function log_normal(quantile) result(diameter)
    real(wp), intent(in) :: quantile
    real(wp) :: diameter

    real(wp) :: low, high
    integer :: k

    low = log(0.5_wp)
    high = log(2.0_wp)
    do k = 1, 40
      if (erf((low + high)/2/0.35_wp/sqrt(2.0_wp)) < (2*quantile - 1)*erf(log(2.0_wp)/0.35_wp/sqrt(2.0_wp))) then
        low = (low + high)/2
      else
        high = (low + high)/2
      end if
    end do
    diameter = 1.0e-3_wp*exp(low)
  end function log_normal

  !> Diameters up to `ratio` times the smallest, of which every factor between has the same volume: by number d^-3 per log d. In
  !> the mean they have the volume of spheres of 1 mm; in no order [m].
  pure function equal_volumes(n, ratio) result(diameter)
    integer, intent(in) :: n
    real(wp), intent(in) :: ratio
    real(wp) :: diameter(n)

    integer :: i

    do i = 1, n
      diameter(i) = (1 - modulo(i*0.6180339887498949_wp, 1.0_wp)*(1 - ratio**(-3)))**(-1.0_wp/3.0_wp)
    end do
    diameter = 1.0e-3_wp*diameter*(n/sum(diameter**3))**(1.0_wp/3.0_wp)
  end function equal_volumes

  !> Places of spheres without overlap in the lowest part of a box, which they fill to a solids fraction of one half [m].
  function packed(diameter, box) result(x)
    real(wp), intent(in) :: diameter(:)  !< (n) [m]
    real(wp), intent(in) :: box(3)       !< from the origin [m]
    real(wp) :: x(3, size(diameter))

    type(spheres_t) :: spheres
    type(box_t) :: part(1)
    type(random_t) :: random
    logical, allocatable :: placed(:)
    integer :: n

    n = size(diameter)
    part(1)%lower = 0.0_wp
    part(1)%upper = [box(1:2), 2*pi/6*sum(diameter**3)/product(box(1:2))]
    part(1)%spans = .false.
    spheres%vessel%lower = part(1)%lower
    spheres%vessel%upper = part(1)%upper
    spheres%vessel%periodic = .false.
    allocate (spheres%position(3, n), spheres%radius(n), spheres%box(n))
    spheres%radius = diameter/2
    spheres%box = 1
    call pack_spheres(part, random, spheres, placed)
    if (.not. all(placed)) error stop 'spheres left out'
    x = spheres%position
  end function packed

end module powders
