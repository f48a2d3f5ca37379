!> Attraction of two parcels, or of a parcel and a wall, along the line of their centres. With h the gap between their
!> surfaces, negative where they overlap, and R = r_i r_j/(r_i + r_j), r of a parcel at a wall,
!>
!>   van der Waals   F = A R/(6 max(h, h_min)^2)   for h < h_max,  A Hamaker's constant
!>   linear          F = k pi a^2,  a^2 = R delta   for delta = -h > 0, the area of Hertz's contact
!>
!> Source: Hamaker, Physica 4 (1937) 1058-1072, for spheres close to each other; h_min for surfaces that touch: Krupp, Adv.
!>         Colloid Interface Sci. 1 (1967) 111-239. Linear: the simplified law of Johnson, Kendall & Roberts, Proc. R. Soc. A 324
!>         (1971) 301-313, that discrete element programs have, k an energy per volume.
!>
!> Friction and rolling resistance do not see the attraction itself but the repulsion of spring and dashpot, which at rest
!> carries load and attraction together: mu (N + F), as Derjaguin, Z. Phys. 88 (1934) 661-675, has it.
module cohesion
  use constants, only: pi
  use contact_lanes, only: lanes
  use kinds, only: wp
  implicit none
  private
  public :: cohesion_t, attractions

  !> Constants of one pair of materials.
  type :: cohesion_t
    logical :: on = .false.
    logical :: van_der_waals = .false.  !< else linear
    real(wp) :: strength = 0.0_wp       !< A/6 [J], or pi k [J/m3]
    real(wp) :: nearest = 0.0_wp        !< h_min [m]
    real(wp) :: reach = 0.0_wp          !< h_max [m]; 0 for the linear one
  contains
    procedure :: time
  end type cohesion_t

contains

  !> Half the swing of a parcel where the attraction is the steepest, dF/dh = A R/(3 h_min^3) [s]. R/m* of any pair lies
  !> between r/m of its two parcels, and is r/m at a wall.
  !>
  !> A step of a twentieth of it need not find every parcel that flies by nearer than h_min: one that crosses that gap in a step,
  !> at h_min/dt, is pulled too much or not at all, by 1 % of its speed; the mean over many is right.
  elemental function time(self, ratio)
    class(cohesion_t), intent(in) :: self
    real(wp), intent(in) :: ratio  !< largest r/m of all parcels [m/kg]
    real(wp) :: time

    time = huge(time)
    if (self%on .and. self%van_der_waals) time = pi*sqrt(self%nearest**3/(2*self%strength*ratio))
  end function time

  !> Forces on i of n pairs (i, j), n a multiple of `lanes`.
  pure subroutine attractions(cohesion, n, pair, curvature, force)
    type(cohesion_t), intent(in) :: cohesion
    integer, intent(in) :: n
    real(wp), intent(in) :: pair(4, n)    !< 1:3 x_i - x_j, 4 r_i + r_j [m]
    real(wp), intent(in) :: curvature(n)  !< 1/R [1/m]
    real(wp), intent(out) :: force(3, n)  !< [N]

    integer :: k

    do k = 1, n, lanes
      if (cohesion%van_der_waals) then
        call across_gaps(cohesion, pair(:, k:k + lanes - 1), curvature(k:k + lanes - 1), force(:, k:k + lanes - 1))
      else
        call by_area(cohesion, pair(:, k:k + lanes - 1), curvature(k:k + lanes - 1), force(:, k:k + lanes - 1))
      end if
    end do
  end subroutine attractions

  pure subroutine across_gaps(cohesion, pair, curvature, force)
    type(cohesion_t), intent(in) :: cohesion
    real(wp), intent(in) :: pair(4, lanes), curvature(lanes)
    real(wp), intent(out) :: force(3, lanes)

    real(wp) :: d, h, pull
    integer :: k

    !$omp simd simdlen(8) private(d, h, pull)
    do k = 1, lanes
      d = sqrt(pair(1, k)*pair(1, k) + pair(2, k)*pair(2, k) + pair(3, k)*pair(3, k))
      h = d - pair(4, k)
      pull = cohesion%strength/(curvature(k)*max(h, cohesion%nearest)**2*d)
      pull = merge(pull, 0.0_wp, h < cohesion%reach)
      force(1, k) = -pull*pair(1, k)
      force(2, k) = -pull*pair(2, k)
      force(3, k) = -pull*pair(3, k)
    end do
  end subroutine across_gaps

  pure subroutine by_area(cohesion, pair, curvature, force)
    type(cohesion_t), intent(in) :: cohesion
    real(wp), intent(in) :: pair(4, lanes), curvature(lanes)
    real(wp), intent(out) :: force(3, lanes)

    real(wp) :: d, pull
    integer :: k

    !$omp simd simdlen(8) private(d, pull)
    do k = 1, lanes
      d = sqrt(pair(1, k)*pair(1, k) + pair(2, k)*pair(2, k) + pair(3, k)*pair(3, k))
      pull = cohesion%strength*max(pair(4, k) - d, 0.0_wp)/(curvature(k)*d)
      force(1, k) = -pull*pair(1, k)
      force(2, k) = -pull*pair(2, k)
      force(3, k) = -pull*pair(3, k)
    end do
  end subroutine by_area

end module cohesion
