!> The contact laws of all materials that meet in a run, each different one once: pairs of materials with equal properties share
!> one, so that materials cost nothing where they make no difference.
module contact_laws
  use contact_law, only: contact_law_t, new_law
  use contact_pairs, only: pair_t, pair_of, wall_pair_of, is_alike
  use contact_settings, only: contact_settings_t
  use kinds, only: wp
  implicit none
  private
  public :: contact_laws_t, new_contact_laws

  !> Materials are numbered from 0, that of &contact.
  type :: contact_laws_t
    type(contact_law_t), allocatable :: pair(:)   !< between parcels
    type(contact_law_t), allocatable :: wall(:)   !< between parcels and walls
    integer, allocatable :: pair_number(:,:)      !< (0:M,0:M) place in `pair`, by materials; 0 where there are no such parcels
    integer, allocatable :: wall_number(:,:)      !< (0:M,0:M) place in `wall`, by materials of parcel and wall; or 0
    integer, allocatable :: material(:)           !< of each powder
    logical :: friction = .false.                 !< whether any contact has it
  contains
    procedure :: materials
    procedure :: set_step
    procedure :: contact_time
    procedure :: swing_time
    procedure :: of_pair
    procedure :: of_wall
  end type contact_laws_t

contains

  !> Without materials all powders are of material 0.
  pure function new_contact_laws(contact, wall_materials) result(laws)
    type(contact_settings_t), intent(in) :: contact
    integer, intent(in) :: wall_materials(:)  !< those there are
    type(contact_laws_t) :: laws

    type(pair_t) :: pairs((materials_of(contact) + 1)**2)
    integer :: a, b, m, n

    m = materials_of(contact)
    allocate (laws%pair_number(0:m, 0:m), laws%wall_number(0:m, 0:m), source=0)
    if (allocated(contact%powder_material)) then
      allocate (laws%material, source=contact%powder_material)
    else
      allocate (laws%material(1), source=0)
    end if
    n = 0
    do b = 0, m
      do a = 0, b
        if (.not. (any(laws%material == a) .and. any(laws%material == b))) cycle
        call find_number(pair_of(contact, a, b), pairs, n, laws%pair_number(a, b))
        laws%pair_number(b, a) = laws%pair_number(a, b)
      end do
    end do
    allocate (laws%pair(n))
    do a = 1, n
      laws%pair(a) = new_law(contact, pairs(a))
    end do
    n = 0
    do b = 0, m
      do a = 0, m
        if (.not. (any(laws%material == a) .and. any(wall_materials == b))) cycle
        call find_number(wall_pair_of(contact, a, b), pairs, n, laws%wall_number(a, b))
      end do
    end do
    allocate (laws%wall(n))
    do a = 1, n
      laws%wall(a) = new_law(contact, pairs(a))
    end do
    laws%friction = any(laws%pair%mu > 0.0_wp) .or. any(laws%wall%mu > 0.0_wp)
  end function new_contact_laws

  pure function materials_of(contact) result(materials)
    type(contact_settings_t), intent(in) :: contact
    integer :: materials

    materials = 0
    if (allocated(contact%materials)) materials = size(contact%materials)
  end function materials_of

  !> The place of a pair among those met so far, where it is put if it is new.
  pure subroutine find_number(pair, pairs, n, number)
    type(pair_t), intent(in) :: pair
    type(pair_t), intent(inout) :: pairs(:)
    integer, intent(inout) :: n
    integer, intent(out) :: number

    do number = 1, n
      if (is_alike(pair, pairs(number))) return
    end do
    n = n + 1
    pairs(n) = pair
  end subroutine find_number

  !> The last material.
  pure function materials(self)
    class(contact_laws_t), intent(in) :: self
    integer :: materials

    materials = ubound(self%pair_number, 1)
  end function materials

  !> The length of the steps that follow, and the number of the next.
  pure subroutine set_step(self, dt)
    class(contact_laws_t), intent(inout) :: self
    real(wp), intent(in) :: dt  !< [s]

    call self%pair%set_step(dt)
    call self%wall%set_step(dt)
  end subroutine set_step

  !> Which of `pair` parcels of two powders have.
  pure function of_pair(self, powder, other) result(number)
    class(contact_laws_t), intent(in) :: self
    integer, intent(in) :: powder, other
    integer :: number

    number = self%pair_number(self%material(powder), self%material(other))
  end function of_pair

  !> Which of `wall` a parcel of a powder and a wall have.
  pure function of_wall(self, powder, wall_material) result(number)
    class(contact_laws_t), intent(in) :: self
    integer, intent(in) :: powder, wall_material
    integer :: number

    number = 1
    if (size(self%wall) > 1) number = self%wall_number(self%material(powder), wall_material)
  end function of_wall

  !> Time the shortest collision takes of those that may be: of the lightest parcels of any two materials, or of one and a
  !> wall [s].
  pure function contact_time(self, lightest, smallest, speed) result(time)
    class(contact_laws_t), intent(in) :: self
    real(wp), intent(in) :: lightest(0:)  !< (0:M) mass of a parcel of each material; huge if there is none [kg]
    real(wp), intent(in) :: smallest(0:)  !< (0:M) radius [m]
    real(wp), intent(in) :: speed         !< of the approach [m/s]
    real(wp) :: time

    real(wp) :: m, r
    integer :: a, b, number

    time = huge(time)
    do a = 0, ubound(lightest, 1)
      if (.not. lightest(a) < huge(time)) cycle
      do b = 0, a
        number = self%pair_number(a, b)
        if (number == 0 .or. .not. lightest(b) < huge(time)) cycle
        m = 0.5_wp*lightest(a)
        r = 0.5_wp*smallest(a)
        if (a /= b) m = 1/(1/lightest(a) + 1/lightest(b))
        if (a /= b) r = 1/(1/smallest(a) + 1/smallest(b))
        time = min(time, self%pair(number)%contact_time(m, r, speed))
      end do
      do b = 0, ubound(lightest, 1)
        number = self%wall_number(a, b)
        if (number > 0) time = min(time, self%wall(number)%contact_time(lightest(a), smallest(a), speed))
      end do
    end do
  end function contact_time

  !> Half the shortest swing by attraction [s].
  pure function swing_time(self, ratio) result(time)
    class(contact_laws_t), intent(in) :: self
    real(wp), intent(in) :: ratio  !< largest r/m of all parcels [m/kg]
    real(wp) :: time

    time = min(minval(self%pair%cohesion%time(ratio)), minval(self%wall%cohesion%time(ratio)))
  end function swing_time

end module contact_laws
