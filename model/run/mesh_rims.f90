!> How meshes that block the gas end at the domain: a tube may go on beyond its faces, with or without lids, or have its rims on
!> them.
!>
!> Corners on a face count as beyond it. What is beyond one face as a whole is no wall: the gas and the parcels come to the face
!> itself. To tell inside from outside every rim gets a cone, whose tip is far out; as it does not come into the domain, its shape
!> does not matter.
module mesh_rims
  use kinds, only: wp
  use surface, only: surface_t
  implicit none
  private
  public :: wall_within, body_over, loose_rim

  real(wp), parameter :: closeness = 1.0e-6_wp  !< of the domain: what counts as lying on a face
  real(wp), parameter :: step_out = 1.0e-5_wp   !< of the domain: by how much corners on a face are put beyond it

  integer, parameter :: no_face = 0

contains

  !> The triangles that are felt: those not beyond one face as a whole.
  pure function wall_within(surface, lower, upper) result(wall)
    type(surface_t), intent(in) :: surface
    real(wp), intent(in) :: lower(3), upper(3)  !< corners of the domain [m]
    type(surface_t) :: wall

    logical, allocatable :: felt(:)
    integer :: t

    wall = put_out(surface, lower, upper)
    felt = [(face_beyond(wall%vertex(:, wall%corner(:, t)), lower, upper) == no_face, t=1, wall%n)]
    wall%corner = wall%corner(:, pack([(t, t=1, wall%n)], felt))
    wall%n = size(wall%corner, 2)
  end function wall_within

  !> All of it, with cones over its rims: closed, as long as there is no loose rim.
  pure function body_over(surface, lower, upper) result(body)
    type(surface_t), intent(in) :: surface
    real(wp), intent(in) :: lower(3), upper(3)  !< corners of the domain [m]
    type(surface_t) :: body

    real(wp), allocatable :: places(:,:)
    real(wp) :: tip(3)
    integer, allocatable :: rim(:), cones(:,:)
    integer :: r, e, face, a

    body = put_out(surface, lower, upper)
    allocate (rim, source=rims(body))
    allocate (cones(3, size(rim)))
    do r = 1, maxval([0, rim])
      allocate (places, source=rim_places(body, rim, r))
      tip = sum(places, 2)/size(places, 2)
      face = face_beyond(places, lower, upper)
      deallocate (places)
      a = (face + 1)/2
      if (face /= no_face) tip(a) = tip(a) + merge(-1, 1, modulo(face, 2) == 1)*(upper(a) - lower(a))
      body%vertex = reshape([body%vertex, tip], [3, size(body%vertex, 2) + 1])
      do e = 1, size(rim)
        if (rim(e) == r) cones(:, e) = [body%open_edge(:, e), size(body%vertex, 2)]
      end do
    end do
    body%corner = reshape([body%corner, cones], [3, body%n + size(rim)])
    body%n = body%n + size(rim)
  end function body_over

  !> A place of a rim that is not beyond one face of the domain [m]; `loose` tells whether there is one.
  pure subroutine loose_rim(surface, lower, upper, loose, place)
    type(surface_t), intent(in) :: surface
    real(wp), intent(in) :: lower(3), upper(3)  !< corners of the domain [m]
    logical, intent(out) :: loose
    real(wp), intent(out) :: place(3)

    type(surface_t) :: body
    integer, allocatable :: rim(:)
    integer :: r, e

    body = put_out(surface, lower, upper)
    allocate (rim, source=rims(body))
    place = 0.0_wp
    do r = 1, maxval([0, rim])
      loose = face_beyond(rim_places(body, rim, r), lower, upper) == no_face
      if (.not. loose) cycle
      ! the first edge of it in the domain, if there is one
      do e = size(rim), 1, -1
        if (rim(e) /= r) cycle
        associate (middle => 0.5_wp*sum(surface%vertex(:, surface%open_edge(:, e)), 2))
          if (all(middle > lower .and. middle < upper) .or. .not. any(abs(place) > 0.0_wp)) place = middle
        end associate
      end do
      return
    end do
    loose = .false.
  end subroutine loose_rim

  !> A surface whose corners on faces of the domain are a little beyond them.
  pure function put_out(surface, lower, upper) result(moved)
    type(surface_t), intent(in) :: surface
    real(wp), intent(in) :: lower(3), upper(3)  !< [m]
    type(surface_t) :: moved

    integer :: a

    moved = surface
    do a = 1, 3
      associate (x => moved%vertex(a, :), near => closeness*(upper(a) - lower(a)), out => step_out*(upper(a) - lower(a)))
        where (abs(surface%vertex(a, :) - lower(a)) <= near) x = lower(a) - out
        where (abs(surface%vertex(a, :) - upper(a)) <= near) x = upper(a) + out
      end associate
    end do
  end function put_out

  !> A face of the domain beyond which all of some places are: 1 to 6 for low and high x, y, z.
  pure function face_beyond(places, lower, upper) result(face)
    real(wp), intent(in) :: places(:,:)         !< (3,n) [m]
    real(wp), intent(in) :: lower(3), upper(3)  !< [m]
    integer :: face

    integer :: a

    do a = 1, 3
      face = 2*a - 1
      if (all(places(a, :) < lower(a))) return
      face = 2*a
      if (all(places(a, :) > upper(a))) return
    end do
    face = no_face
  end function face_beyond

  !> Which rim each open edge belongs to, numbered from 1: edges that share a corner are of one.
  pure function rims(surface) result(rim)
    type(surface_t), intent(in) :: surface
    integer, allocatable :: rim(:)

    integer :: next(size(surface%vertex, 2))    ! the way from a corner to the one that stands for its rim
    integer :: number(size(surface%vertex, 2))  ! of the rim that a corner stands for
    integer :: e, k, n, ends(2)

    next = [(k, k=1, size(next))]
    do e = 1, size(surface%open_edge, 2)
      ends = surface%open_edge(:, e)
      do k = 1, 2
        do while (next(ends(k)) /= ends(k))
          next(ends(k)) = next(next(ends(k)))
          ends(k) = next(ends(k))
        end do
      end do
      next(maxval(ends)) = minval(ends)
    end do
    allocate (rim(size(surface%open_edge, 2)))
    number = 0
    n = 0
    do e = 1, size(rim)
      k = surface%open_edge(1, e)
      do while (next(k) /= k)
        k = next(k)
      end do
      if (number(k) == 0) then
        n = n + 1
        number(k) = n
      end if
      rim(e) = number(k)
    end do
  end function rims

  !> The ends of the edges of one rim (3,n) [m].
  pure function rim_places(surface, rim, r) result(places)
    type(surface_t), intent(in) :: surface
    integer, intent(in) :: rim(:), r
    real(wp), allocatable :: places(:,:)

    integer, allocatable :: edges(:)
    integer :: e

    edges = pack([(e, e=1, size(rim))], rim == r)
    places = surface%vertex(:, reshape(surface%open_edge(:, edges), [2*size(edges)]))
  end function rim_places

end module mesh_rims
