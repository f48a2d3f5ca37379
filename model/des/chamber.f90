!> What holds the parcels: a box, what its faces do, walls within it, and gravity.
module chamber
  use kinds, only: wp
  use mesh_wall, only: mesh_wall_t, new_mesh_wall
  use plane, only: plane_t, new_plane
  use shell, only: shell_t, new_shell
  use surface, only: surface_t
  use wall_settings, only: wall_settings_t
  implicit none
  private
  public :: chamber_t, face_normal, n_faces

  integer, parameter :: n_faces = 6  !< low and high x, low and high y, low and high z

  !> Faces are numbered 1 to 6: low x, high x, low y, high y, low z, high z. Planes go on with 7,
  !> shells after them, then each triangle of the meshes.
  type :: chamber_t
    real(wp) :: lower(3), upper(3)           !< corners [m]
    logical :: periodic(3) = .false.         !< whether opposite faces are joined
    logical :: open(2, 3) = .false.          !< low and high face of each direction: parcels leave there
    real(wp) :: gravity(3) = 0.0_wp          !< [m/s2]
    integer :: face_material(n_faces) = 0    !< see contact_pairs
    integer :: n_planes = 0, n_shells = 0, n_meshes = 0
    type(plane_t), allocatable :: planes(:)  !< exist if there are any
    type(shell_t), allocatable :: shells(:)  !< exist if there are any
    type(mesh_wall_t), allocatable :: meshes(:)  !< exist if there are any
    real(wp) :: fastest = 0.0_wp             !< speed of any wall that moves itself [m/s]
    real(wp) :: time = 0.0_wp                !< for which such walls are where they are [s]
  contains
    procedure :: add_walls
    procedure :: move_to
    procedure :: way_since
    procedure :: first_triangle
    procedure :: mesh_of
    procedure :: find_images
    procedure :: shift
    procedure :: is_wall
    procedure :: material_of
    procedure :: materials
    procedure :: distance
    procedure :: approach
    procedure :: approach_shell
    procedure :: spin_of
    procedure :: is_beyond
  end type chamber_t

contains

  !> Put walls into the box, which has none yet.
  pure subroutine add_walls(self, settings, surfaces)
    class(chamber_t), intent(inout) :: self
    type(wall_settings_t), intent(in) :: settings(:)
    type(surface_t), intent(in), optional :: surfaces(:)  !< (walls) of those that are meshes; may miss if none is

    integer :: w, p, s, m, triangles

    self%n_planes = count(settings%kind == 'plane')
    self%n_meshes = count(settings%kind == 'mesh')
    self%n_shells = size(settings) - self%n_planes - self%n_meshes
    if (self%n_planes > 0) allocate (self%planes(self%n_planes))
    if (self%n_shells > 0) allocate (self%shells(self%n_shells))
    if (self%n_meshes > 0) allocate (self%meshes(self%n_meshes))
    p = 0
    s = 0
    m = 0
    triangles = 0
    do w = 1, size(settings)
      if (settings(w)%kind == 'plane') then
        p = p + 1
        self%planes(p) = new_plane(settings(w))
      else if (settings(w)%kind == 'mesh') then
        m = m + 1
        self%meshes(m) = new_mesh_wall(settings(w), surfaces(w), triangles)
        triangles = triangles + self%meshes(m)%n
        self%fastest = max(self%fastest, self%meshes(m)%fastest)
      else
        s = s + 1
        self%shells(s) = new_shell(settings(w))
      end if
    end do
    if (self%n_shells > 1) call join_shells(self%shells)
  end subroutine add_walls

  !> Put the walls that move where they are at a time [s].
  pure subroutine move_to(self, time)
    class(chamber_t), intent(inout) :: self
    real(wp), intent(in) :: time

    integer :: m

    self%time = time
    do m = 1, self%n_meshes
      if (self%meshes(m)%moves) call self%meshes(m)%move_to(time)
    end do
  end subroutine move_to

  !> How far a wall may have gone since a time [m].
  pure function way_since(self, time) result(way)
    class(chamber_t), intent(in) :: self
    real(wp), intent(in) :: time  !< [s]
    real(wp) :: way

    way = self%fastest*(self%time - time)
  end function way_since

  !> The number of the first triangle of all.
  pure function first_triangle(self) result(face)
    class(chamber_t), intent(in) :: self
    integer :: face

    face = n_faces + self%n_planes + self%n_shells + 1
  end function first_triangle

  !> The mesh a triangle belongs to.
  pure function mesh_of(self, face) result(m)
    class(chamber_t), intent(in) :: self
    integer, intent(in) :: face
    integer :: m

    do m = self%n_meshes, 1, -1
      if (face - self%first_triangle() >= self%meshes(m)%before) return
    end do
  end function mesh_of

  !> The images of a parcel that have a part of the chamber within a reach: numbers as `shift` takes them, first the parcel itself.
  pure subroutine find_images(self, x, reach, images, n)
    class(chamber_t), intent(in) :: self
    real(wp), intent(in) :: x(3), reach  !< [m]
    integer, intent(out) :: images(8), n

    integer :: a, digit

    n = 1
    images(1) = 0
    do a = 1, 3
      if (.not. self%periodic(a)) cycle
      digit = 0
      if (x(a) - self%lower(a) < reach) digit = 1
      if (self%upper(a) - x(a) < reach) digit = 2
      if (digit == 0) cycle
      images(n + 1:2*n) = images(1:n) + digit*3**(a - 1)
      n = 2*n
    end do
  end subroutine find_images

  !> From a parcel to an image of it. The digits of its number to the base of 3: 0 here, 1 a period up, 2 a period down [m].
  pure function shift(self, image)
    class(chamber_t), intent(in) :: self
    integer, intent(in) :: image
    real(wp) :: shift(3)

    integer :: a

    do a = 1, 3
      select case (modulo(image/3**(a - 1), 3))
      case (1)
        shift(a) = self%upper(a) - self%lower(a)
      case (2)
        shift(a) = self%lower(a) - self%upper(a)
      case default
        shift(a) = 0.0_wp
      end select
    end do
  end function shift

  !> Find the rims that two shells share.
  pure subroutine join_shells(shells)
    type(shell_t), intent(inout) :: shells(:)

    integer :: s, end, other

    do s = 1, size(shells)
      do end = 1, 2
        do other = size(shells), 1, -1
          if (other == s) cycle
          if (shells(s)%shares_rim(end, shells(other))) shells(s)%joined(end) = other
        end do
      end do
    end do
  end subroutine join_shells

  !> Whether parcels bounce off a face.
  pure function is_wall(self, face)
    class(chamber_t), intent(in) :: self
    integer, intent(in) :: face
    logical :: is_wall

    integer :: axis

    axis = (face + 1)/2
    is_wall = .not. (self%periodic(axis) .or. self%open(face - 2*axis + 2, axis))
  end function is_wall

  !> What a wall is made of: see contact_pairs.
  pure function material_of(self, face) result(material)
    class(chamber_t), intent(in) :: self
    integer, intent(in) :: face
    integer :: material

    if (face >= self%first_triangle()) then
      material = self%meshes(self%mesh_of(face))%material
    else if (face > n_faces + self%n_planes) then
      material = self%shells(face - n_faces - self%n_planes)%material
    else if (face > n_faces) then
      material = self%planes(face - n_faces)%material
    else
      material = self%face_material(face)
    end if
  end function material_of

  !> What all walls are made of.
  pure function materials(self)
    class(chamber_t), intent(in) :: self
    integer, allocatable :: materials(:)

    integer :: face

    materials = pack(self%face_material, [(self%is_wall(face), face=1, n_faces)])
    if (self%n_planes > 0) materials = [materials, self%planes%material]
    if (self%n_shells > 0) materials = [materials, self%shells%material]
    if (self%n_meshes > 0) materials = [materials, self%meshes%material]
  end function materials

  !> Distance of a point from a wall, positive where parcels may be [m].
  pure function distance(self, face, x)
    class(chamber_t), intent(in) :: self
    integer, intent(in) :: face
    real(wp), intent(in) :: x(3)  !< [m]
    real(wp) :: distance

    real(wp) :: way(3)
    integer :: axis, bearers(2), m

    if (face >= self%first_triangle()) then
      m = self%mesh_of(face)
      call self%meshes(m)%approach(face - self%first_triangle() + 1 - self%meshes(m)%before, self%meshes(m)%seen(x), way, &
                                   distance, bearers)
    else if (face > n_faces + self%n_planes) then
      call self%approach_shell(face - n_faces - self%n_planes, x, way, distance)
    else if (face > n_faces) then
      distance = self%planes(face - n_faces)%distance(x)
    else
      axis = (face + 1)/2
      if (modulo(face, 2) == 1) then
        distance = x(axis) - self%lower(axis)
      else
        distance = self%upper(axis) - x(axis)
      end if
    end if
  end function distance

  !> The way from the nearest point of a wall, not of a mesh, and its length, positive where parcels may be.
  pure subroutine approach(self, face, x, way, distance)
    class(chamber_t), intent(in) :: self
    integer, intent(in) :: face
    real(wp), intent(in) :: x(3)       !< [m]
    real(wp), intent(out) :: way(3)    !< [m]
    real(wp), intent(out) :: distance  !< [m]

    if (face > n_faces + self%n_planes) then
      call self%approach_shell(face - n_faces - self%n_planes, x, way, distance)
    else
      distance = self%distance(face, x)
      if (face > n_faces) then
        way = distance*self%planes(face - n_faces)%normal
      else
        way = distance*face_normal(face)
      end if
    end if
  end subroutine approach

  !> The way from the nearest point of a shell, and its length. A rim shared with another shell is felt once, and only
  !> where neither has a point that is nearer: elsewhere the distance is huge.
  pure subroutine approach_shell(self, s, x, way, distance)
    class(chamber_t), intent(in) :: self
    integer, intent(in) :: s           !< place in `shells`
    real(wp), intent(in) :: x(3)       !< [m]
    real(wp), intent(out) :: way(3)    !< [m]
    real(wp), intent(out) :: distance  !< [m]

    real(wp) :: other_way(3), other_distance
    integer :: end, other, other_end
    logical :: felt

    call self%shells(s)%approach(x, way, distance, end)
    if (end == 0) return
    other = self%shells(s)%joined(end)
    if (other == 0) return
    call self%shells(other)%approach(x, other_way, other_distance, other_end)
    felt = other_end > 0 .and. s < other
    if (felt) felt = self%shells(other)%joined(other_end) == s
    if (.not. felt) distance = huge(distance)
  end subroutine approach_shell

  !> Angular velocity of a wall's surface [rad/s].
  pure function spin_of(self, face) result(spin)
    class(chamber_t), intent(in) :: self
    integer, intent(in) :: face
    real(wp) :: spin(3)

    if (face <= n_faces) then
      spin = 0.0_wp
    else if (face <= n_faces + self%n_planes) then
      spin = self%planes(face - n_faces)%motion%spin
    else if (face < self%first_triangle()) then
      spin = self%shells(face - n_faces - self%n_planes)%motion%spin
    else
      spin = self%meshes(self%mesh_of(face))%motion%spin
    end if
  end function spin_of

  !> Whether a parcel is beyond one of the walls within the box, or about to be.
  pure function is_beyond(self, x, radius)
    class(chamber_t), intent(in) :: self
    real(wp), intent(in) :: x(3)    !< [m]
    real(wp), intent(in) :: radius  !< [m]
    logical :: is_beyond

    integer :: m

    is_beyond = .false.
    do m = 1, self%n_planes
      is_beyond = is_beyond .or. .not. self%planes(m)%distance(x) > 0.0_wp
    end do
    do m = 1, self%n_shells
      is_beyond = is_beyond .or. self%shells(m)%is_beyond(self%shells(m)%distance(x), radius)
    end do
    do m = 1, self%n_meshes
      is_beyond = is_beyond .or. self%meshes(m)%is_beyond(x, radius)
    end do
  end function is_beyond

  !> Unit vector from a face into the box.
  pure function face_normal(face) result(normal)
    integer, intent(in) :: face
    real(wp) :: normal(3)

    normal = 0.0_wp
    normal((face + 1)/2) = merge(1.0_wp, -1.0_wp, modulo(face, 2) == 1)
  end function face_normal

end module chamber
