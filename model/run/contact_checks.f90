!> Mistakes in what contacts are like that no group shows alone: whether materials and pairs of them fit what &contact asks for.
module contact_checks
  use case, only: case_t
  use case_keys, only: keys_t
  use constants, only: pi, is_set
  use contact_law, only: contact_law_t
  use contact_laws, only: contact_laws_t, new_contact_laws
  use contact_settings, only: contact_settings_t
  use kinds, only: wp
  use text, only: brief
  implicit none
  private
  public :: check_contacts

  real(wp), parameter :: largest_cohesion = 0.1_wp  !< over the effective modulus: 6 % of R overlap at rest

contains

  !> Of a case with parcels. What follows for pairs is looked at once all records are right.
  subroutine check_contacts(case, keys)
    type(case_t), intent(in) :: case
    type(keys_t), intent(inout) :: keys

    if (allocated(case%contact%materials)) call check_choices(case%contact, keys)
    if (keys%problems%count() == 0) call check_pairs(case%contact, case%wall_materials(), keys)
  end subroutine check_contacts

  !> Properties of materials and pairs belong to effects that &contact asks for.
  subroutine check_choices(contact, keys)
    type(contact_settings_t), intent(in) :: contact
    type(keys_t), intent(inout) :: keys

    character(len=*), parameter :: of_rolling = 'belongs to rolling = ''constant_torque'' or ''spring'' of &contact'
    integer :: i

    do i = 1, size(contact%materials)
      associate (m => contact%materials(i))
        call check_choice('material', i, [m%rolling_friction, m%rolling_damping, m%hamaker_constant, m%cohesion_energy])
      end associate
    end do
    do i = 1, size(contact%pairs)
      associate (p => contact%pairs(i))
        call check_choice('material_pair', i, [p%rolling_friction, p%rolling_damping, p%hamaker_constant, p%cohesion_energy])
      end associate
    end do

  contains

    subroutine check_choice(group, i, values)
      character(len=*), intent(in) :: group
      integer, intent(in) :: i
      real(wp), intent(in) :: values(4)  !< unset where not given

      logical :: wanted(4)

      wanted = [contact%rolling /= 'none', contact%rolling /= 'none', contact%cohesion == 'van_der_waals', &
                contact%cohesion == 'linear'] .or. .not. is_set(values)
      call keys%require_at(wanted(1), group, i, 'rolling_friction', of_rolling)
      call keys%require_at(wanted(2), group, i, 'rolling_damping', of_rolling)
      call keys%require_at(wanted(3), group, i, 'hamaker_constant', 'belongs to cohesion = ''van_der_waals'' of &contact')
      call keys%require_at(wanted(4), group, i, 'cohesion_energy', 'belongs to cohesion = ''linear'' of &contact')
    end subroutine check_choice

  end subroutine check_choices

  !> What is asked for is there in some contact that may be, and none is drawn together too much.
  subroutine check_pairs(contact, walls, keys)
    type(contact_settings_t), intent(in) :: contact
    integer, intent(in) :: walls(:)  !< materials
    type(keys_t), intent(inout) :: keys

    type(contact_laws_t) :: laws
    integer :: a, b

    laws = new_contact_laws(contact, walls)
    if (contact%rolling /= 'none') then
      call keys%require_at(laws%friction, 'contact', 1, 'rolling', &
                           'needs friction, and no two materials that meet have any: parcels without it do not rotate')
      call keys%require_at(any(laws%pair%rolling%on) .or. any(laws%wall%rolling%on), 'contact', 1, 'rolling', &
                           'no two materials that meet have rolling friction: write ''none''')
    end if
    if (contact%cohesion /= 'none') then
      call keys%require_at(any(laws%pair%cohesion%on) .or. any(laws%wall%cohesion%on), 'contact', 1, 'cohesion', &
                           'no two materials that meet attract each other: write ''none''')
    end if
    if (contact%cohesion /= 'linear') return
    do a = 0, laws%materials()
      do b = 0, laws%materials()
        if (laws%pair_number(a, b) > 0) call check_strength(contact, laws%pair(laws%pair_number(a, b)), a, b, .false., keys)
        if (keys%problems%count() > 0) return
        if (laws%wall_number(a, b) > 0) call check_strength(contact, laws%wall(laws%wall_number(a, b)), a, b, .true., keys)
        if (keys%problems%count() > 0) return
      end do
    end do
  end subroutine check_pairs

  !> Of the attraction by area between materials a and b, or a and walls of b; 0: none.
  subroutine check_strength(contact, law, a, b, of_wall, keys)
    type(contact_settings_t), intent(in) :: contact
    type(contact_law_t), intent(in) :: law
    integer, intent(in) :: a, b
    logical, intent(in) :: of_wall
    type(keys_t), intent(inout) :: keys

    character(len=:), allocatable :: group, key, partners
    real(wp) :: energy, most
    integer :: i

    energy = law%cohesion%strength/pi
    most = largest_cohesion*law%hertz%modulus
    if (energy <= most) return
    partners = 'parcels'
    if (a > 0) partners = trim(contact%materials(a)%id)
    if (of_wall .and. b == 0) then
      partners = partners//' into walls'
    else if (a == b) then
      partners = partners//' into each other'
    else
      if (b == 0) partners = partners//' and parcels'
      if (b > 0) partners = partners//' and '//trim(contact%materials(b)%id)
      partners = partners//' into each other'
    end if
    call find_energy(contact, a, b, of_wall, group, i, key)
    call keys%require_at(.false., group, i, key, 'draws '//partners//': it is '//brief(energy)//' J/m3 there, and at most '// &
                         brief(most)//', a tenth of the effective modulus, may be')
  end subroutine check_strength

  !> Where the energy of two materials was given, or the larger of those it is the mean of.
  pure subroutine find_energy(contact, a, b, of_wall, group, i, key)
    type(contact_settings_t), intent(in) :: contact
    integer, intent(in) :: a, b
    logical, intent(in) :: of_wall
    character(len=:), allocatable, intent(out) :: group, key
    integer, intent(out) :: i

    real(wp) :: energy, largest
    integer :: partners(2), k
    logical :: given

    key = 'cohesion_energy'
    group = 'material_pair'
    do i = 1, size(contact%pairs)
      associate (p => contact%pairs(i))
        if (minval(p%materials) == min(a, b) .and. maxval(p%materials) == max(a, b) .and. is_set(p%cohesion_energy)) return
      end associate
    end do
    i = 1
    group = 'contact'
    partners = [a, b]
    if (of_wall .and. b == 0) then
      key = 'wall_cohesion_energy'
      if (is_set(contact%wall_cohesion_energy)) return
      key = 'cohesion_energy'
      partners = a
    end if
    largest = 0.0_wp
    do k = 1, 2
      given = .false.
      if (partners(k) > 0) given = contact%materials(partners(k))%gives('cohesion_energy')
      energy = contact%cohesion_energy
      if (given) energy = contact%materials(partners(k))%cohesion_energy
      if (.not. energy > largest) cycle
      largest = energy
      group = 'contact'
      if (given) group = 'material'
      i = merge(partners(k), 1, given)
    end do
  end subroutine find_energy

end module contact_checks
