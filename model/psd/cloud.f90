!> Parcels at the start of a run, all on one rank, before they are handed out.
module cloud
  use kinds, only: wp, i8
  implicit none
  private
  public :: cloud_t, new_cloud

  type :: cloud_t
    integer :: n = 0                              !< parcels
    real(wp), allocatable :: position(:, :)       !< (3,n) centres [m]
    real(wp), allocatable :: velocity(:, :)       !< (3,n) [m/s]
    real(wp), allocatable :: diameter(:)          !< (n) of the real particles [m]
    real(wp), allocatable :: weight(:)            !< (n) real particles per parcel [-]
    real(wp), allocatable :: contact_diameter(:)  !< (n) at which parcels touch, d W^(1/3) [m]
    real(wp), allocatable :: density(:)           !< (n) of the particles [kg/m3]
    integer, allocatable :: powder(:)             !< (n) index of the powder
    integer, allocatable :: fill(:)               !< (n) index of the fill
    integer(i8), allocatable :: id(:)             !< (n) 1 to n
  contains
    procedure :: append
  end type cloud_t

contains

  !> n parcels of which nothing is known but their ids.
  pure function new_cloud(n) result(cloud)
    integer, intent(in) :: n
    type(cloud_t) :: cloud

    integer :: i

    cloud%n = n
    allocate (cloud%position(3, n), cloud%velocity(3, n), source=0.0_wp)
    allocate (cloud%diameter(n), cloud%weight(n), cloud%contact_diameter(n), cloud%density(n), source=0.0_wp)
    allocate (cloud%powder(n), cloud%fill(n), source=0)
    allocate (cloud%id(n))
    do i = 1, n
      cloud%id(i) = i
    end do
  end function new_cloud

  !> Add the parcels of another cloud behind mine; they get new ids.
  pure subroutine append(self, other)
    class(cloud_t), intent(inout) :: self
    type(cloud_t), intent(in) :: other

    type(cloud_t) :: both

    both = new_cloud(self%n + other%n)
    both%position(:, :) = reshape([self%position, other%position], [3, both%n])
    both%velocity(:, :) = reshape([self%velocity, other%velocity], [3, both%n])
    both%diameter(:) = [self%diameter, other%diameter]
    both%weight(:) = [self%weight, other%weight]
    both%contact_diameter(:) = [self%contact_diameter, other%contact_diameter]
    both%density(:) = [self%density, other%density]
    both%powder(:) = [self%powder, other%powder]
    both%fill(:) = [self%fill, other%fill]
    self%n = both%n
    call move_alloc(both%position, self%position)
    call move_alloc(both%velocity, self%velocity)
    call move_alloc(both%diameter, self%diameter)
    call move_alloc(both%weight, self%weight)
    call move_alloc(both%contact_diameter, self%contact_diameter)
    call move_alloc(both%density, self%density)
    call move_alloc(both%powder, self%powder)
    call move_alloc(both%fill, self%fill)
    call move_alloc(both%id, self%id)
  end subroutine append

end module cloud
