!> A plane without end. Parcels live on the side its normal points to.
module plane
  use kinds, only: wp
  use wall_motion, only: wall_motion_t
  use wall_settings, only: wall_settings_t
  implicit none
  private
  public :: plane_t, new_plane

  type :: plane_t
    real(wp) :: point(3)   !< of the plane [m]
    real(wp) :: normal(3)  !< unit vector towards the parcels
    type(wall_motion_t) :: motion
    integer :: material = 0  !< see contact_pairs
  contains
    procedure :: distance
  end type plane_t

contains

  pure function new_plane(settings) result(plane)
    type(wall_settings_t), intent(in) :: settings
    type(plane_t) :: plane

    plane%point = settings%point
    plane%normal = settings%direction()
    plane%motion = settings%motion()
    plane%material = settings%material
  end function new_plane

  !> Distance of a point, positive on the parcels' side [m].
  pure function distance(self, x)
    class(plane_t), intent(in) :: self
    real(wp), intent(in) :: x(3)  !< [m]
    real(wp) :: distance

    distance = dot_product(x - self%point, self%normal)
  end function distance

end module plane
