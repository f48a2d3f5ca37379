!> Chambers with walls in them for the tests of model/des.
module wall_scenes
  use chamber, only: chamber_t
  use communicator, only: communicator_t
  use constants, only: pi
  use contact_settings, only: contact_settings_t
  use des_settings, only: des_settings_t
  use kinds, only: wp
  use solids, only: solids_t
  use wall_settings, only: wall_settings_t
  implicit none
  private
  public :: material, room, plane, cylinder, cone, mass_of, column, g, tilt, level

  real(wp), parameter :: g = 9.81_wp
  real(wp), parameter :: tilt(3) = [0.36_wp, 0.48_wp, 0.8_wp]     !< a unit vector
  real(wp), parameter :: level(3) = [0.8_wp, -0.6_wp, 0.0_wp]     !< one across it

contains

  function material(stiffness, restitution, friction) result(contact)
    real(wp), intent(in) :: stiffness, restitution, friction
    type(contact_settings_t) :: contact

    contact%stiffness = stiffness
    contact%restitution = restitution
    contact%friction = friction
    contact%tangential_ratio = 1.0_wp
  end function material

  !> An empty cube from the origin with walls in it.
  function room(ranks, edge, gravity, contact, walls) result(solids)
    type(communicator_t), intent(in) :: ranks
    real(wp), intent(in) :: edge        !< [m]
    real(wp), intent(in) :: gravity(3)  !< [m/s2]
    type(contact_settings_t), intent(in) :: contact
    type(wall_settings_t), intent(in) :: walls(:)
    type(solids_t) :: solids

    type(chamber_t) :: chamber

    chamber%lower = 0.0_wp
    chamber%upper = edge
    chamber%gravity = gravity
    call chamber%add_walls(walls)
    call solids%create(ranks, chamber, contact, des_settings_t(), .false., 0.0_wp)
  end function room

  function plane(point, normal) result(wall)
    real(wp), intent(in) :: point(3), normal(3)
    type(wall_settings_t) :: wall

    wall%kind = 'plane'
    wall%point = point
    wall%normal = normal
    wall%rotation_centre = point
  end function plane

  function cylinder(point, axis, radius) result(wall)
    real(wp), intent(in) :: point(3), axis(3), radius
    type(wall_settings_t) :: wall

    wall%kind = 'cylinder'
    wall%point = point
    wall%axis = axis
    wall%radius = radius
    wall%rotation_centre = point
  end function cylinder

  function cone(point, radius, end_point, end_radius) result(wall)
    real(wp), intent(in) :: point(3), radius, end_point(3), end_radius
    type(wall_settings_t) :: wall

    wall%kind = 'cone'
    wall%point = point
    wall%radius = radius
    wall%end_point = end_point
    wall%end_radius = end_radius
    wall%rotation_centre = point
  end function cone

  !> Of a ball of density 2500 [kg].
  pure function mass_of(diameter) result(mass)
    real(wp), intent(in) :: diameter
    real(wp) :: mass

    mass = 2500*pi/6*diameter**3
  end function mass_of

  !> One parcel's place or velocity as `put` takes it.
  pure function column(x)
    real(wp), intent(in) :: x(3)
    real(wp) :: column(3, 1)

    column(:, 1) = x
  end function column

end module wall_scenes
