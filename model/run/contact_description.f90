!> The contacts of a case, in a few lines: of all, or of every pair of materials that may meet.
module contact_description
  use case, only: case_t
  use constants, only: is_set
  use contact_laws, only: contact_laws_t, new_contact_laws
  use contact_pairs, only: pair_t, pair_of, wall_pair_of
  use contact_settings, only: contact_settings_t
  use described_line, only: line
  use text, only: brief, shown
  implicit none
  private
  public :: describe_contact

contains

  !> For a case without mistakes.
  subroutine describe_contact(case, unit)
    type(case_t), intent(in) :: case
    integer, intent(in) :: unit

    type(contact_laws_t) :: laws

    laws = new_contact_laws(case%contact, case%wall_materials())
    if (allocated(case%contact%materials)) then
      call describe_pairs(case%contact, laws, unit)
    else
      call describe_one(case%contact, pair_of(case%contact, 0, 0), unit)
    end if
    if (is_set(case%contact%coarseness)) call line(unit, '', 'scaled to parcels '//brief(case%contact%coarseness) &
                                                   //' times as wide as their particles')
    call describe_cohesion(case%contact, unit)
    if (laws%friction) then
      call line(unit, '', 'friction'//one_friction(case%contact)//': parcels rotate, contacts remember their slip')
      call describe_rolling(case%contact, unit)
    else
      call line(unit, '', 'no friction: no rotation, no memory of contacts')
    end if
  end subroutine describe_contact

  !> What is common to all; how strong it is of all, or else of the pairs, where materials are.
  subroutine describe_cohesion(contact, unit)
    type(contact_settings_t), intent(in) :: contact
    integer, intent(in) :: unit

    character(len=:), allocatable :: strength

    strength = ''
    if (.not. allocated(contact%materials)) strength = ','//strengths(attraction(contact, pair_of(contact, 0, 0)), &
                                                                      attraction(contact, wall_pair_of(contact, 0, 0)), ' at walls')
    select case (contact%cohesion)
    case ('van_der_waals')
      call line(unit, '', 'van der Waals attraction'//strength//', up to a gap of '//brief(contact%maximum_separation) &
                //' m, constant below '//brief(contact%minimum_separation)//' m')
    case ('linear')
      call line(unit, '', 'attraction over the area of contact'//strength)
    case default
    end select
  end subroutine describe_cohesion

  subroutine describe_rolling(contact, unit)
    type(contact_settings_t), intent(in) :: contact
    integer, intent(in) :: unit

    type(pair_t) :: pair, wall
    character(len=:), allocatable :: words

    if (contact%rolling == 'none') return
    words = 'rolling friction'
    if (.not. allocated(contact%materials)) then
      pair = pair_of(contact, 0, 0)
      wall = wall_pair_of(contact, 0, 0)
      words = words//strengths(shown(pair%rolling_friction), shown(wall%rolling_friction), ' on walls')
    end if
    if (contact%rolling == 'spring') then
      words = words//' by a spring: contacts remember the angle they have rolled'
    else
      words = words//' by a constant torque, which holds nothing at rest'
    end if
    call line(unit, '', words)
  end subroutine describe_rolling

  !> ' 0.1', or ' 0.1, 0.2 on walls'.
  pure function strengths(between_parcels, with_walls, where)
    character(len=*), intent(in) :: between_parcels, with_walls, where
    character(len=:), allocatable :: strengths

    strengths = ' '//between_parcels
    if (with_walls /= between_parcels) strengths = strengths//', '//with_walls//where
  end function strengths

  !> How strongly a pair attracts.
  pure function attraction(contact, pair) result(words)
    type(contact_settings_t), intent(in) :: contact
    type(pair_t), intent(in) :: pair
    character(len=:), allocatable :: words

    words = ''
    if (contact%cohesion == 'van_der_waals') words = brief(pair%hamaker_constant)//' J'
    if (contact%cohesion == 'linear') words = brief(pair%cohesion_energy)//' J/m3'
  end function attraction

  subroutine describe_one(contact, pair, unit)
    type(contact_settings_t), intent(in) :: contact
    type(pair_t), intent(in) :: pair
    integer, intent(in) :: unit

    character(len=:), allocatable :: words

    if (contact%law == 'hertz') then
      words = 'Hertz, modulus '//shown(pair%one%modulus)//' Pa, Poisson''s ratio '//shown(pair%one%poisson)
    else
      words = 'linear spring '//shown(pair%stiffness)//' N/m'
    end if
    call line(unit, 'contact', words//', restitution '//shown(pair%restitution)//' for every pair')
  end subroutine describe_one

  pure function one_friction(contact) result(words)
    type(contact_settings_t), intent(in) :: contact
    character(len=:), allocatable :: words

    words = ''
    if (.not. allocated(contact%materials)) words = ' '//shown(contact%friction)
  end function one_friction

  !> A line for every pair of parcels' materials, and of these and walls'.
  subroutine describe_pairs(contact, laws, unit)
    type(contact_settings_t), intent(in) :: contact
    type(contact_laws_t), intent(in) :: laws
    integer, intent(in) :: unit

    character(len=:), allocatable :: words
    integer :: a, b

    call line(unit, 'contact', trim(merge('Hertz and Mindlin', 'linear springs   ', contact%law == 'hertz'))//'; ' &
              //shown(size(laws%pair))//' different between parcels, '//shown(size(laws%wall))//' with walls')
    do a = 0, laws%materials()
      do b = a, laws%materials()
        if (laws%pair_number(a, b) == 0) cycle
        call line(unit, '', name(contact, a)//' - '//name(contact, b)//': '//properties(contact, pair_of(contact, a, b)))
      end do
    end do
    do a = 0, laws%materials()
      do b = 0, laws%materials()
        if (laws%wall_number(a, b) == 0) cycle
        words = name(contact, a)//' - wall'
        if (b > 0) words = words//' of '//name(contact, b)
        call line(unit, '', words//': '//properties(contact, wall_pair_of(contact, a, b)))
      end do
    end do
  end subroutine describe_pairs

  pure function name(contact, material) result(words)
    type(contact_settings_t), intent(in) :: contact
    integer, intent(in) :: material
    character(len=:), allocatable :: words

    words = 'no material'
    if (material > 0) words = trim(contact%materials(material)%id)
  end function name

  pure function properties(contact, pair) result(words)
    type(contact_settings_t), intent(in) :: contact
    type(pair_t), intent(in) :: pair
    character(len=:), allocatable :: words

    if (contact%law == 'hertz') then
      words = 'modulus '//brief(1/((1 - pair%one%poisson**2)/pair%one%modulus + (1 - pair%other%poisson**2)/pair%other%modulus)) &
              //' Pa together'
    else
      words = 'spring '//brief(pair%stiffness)//' N/m'
    end if
    words = words//', restitution '//brief(pair%restitution)
    if (pair%friction > 0) words = words//', friction '//brief(pair%friction)
    if (contact%rolling /= 'none') words = words//', rolling friction '//brief(pair%rolling_friction)
    if (contact%cohesion /= 'none') words = words//', attraction '//attraction(contact, pair)
  end function properties

end module contact_description
